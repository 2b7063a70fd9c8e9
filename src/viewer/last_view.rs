//! The last view of every city, remembered between windows: one small file in the user's state folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::output::PathKey;

/// How a city was left.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Left {
    view: PathKey,
    /// Seconds since 1970.
    at_s: u64,
}

/// By the city's folder.
type Views = BTreeMap<String, Left>;

/// Cities remembered.
const MAX_CITIES: usize = 200;

/// A folder of the user's: what a variable names, or one of the home folder.
fn user_folder(variable: &str, in_home: &str) -> Option<PathBuf> {
    let named = std::env::var_os(variable)
        .map(PathBuf::from)
        .filter(|path| path.is_absolute());
    let home = || std::env::var_os("HOME").map(|home| PathBuf::from(home).join(in_home));
    Some(named.or_else(home)?.join("rilievo"))
}

/// Where cities that the program makes by itself go.
pub fn data_folder() -> Option<PathBuf> {
    user_folder("XDG_DATA_HOME", ".local/share")
}

fn file() -> Option<PathBuf> {
    Some(user_folder("XDG_STATE_HOME", ".local/state")?.join("views.json"))
}

/// The cities opened before, the last first.
pub fn recent_cities() -> Vec<PathBuf> {
    let views = file().map(|path| read(&path)).unwrap_or_default();
    let mut cities: Vec<(u64, PathBuf)> = views
        .into_iter()
        .map(|(city, left)| (left.at_s, PathBuf::from(city)))
        .filter(|(_, city)| city.join("city.toml").is_file())
        .collect();
    cities.sort_by(|a, b| b.cmp(a));
    cities.into_iter().map(|(_, city)| city).collect()
}

fn read(path: &Path) -> Views {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

fn name(city: &Path) -> String {
    let whole = std::fs::canonicalize(city).unwrap_or_else(|_| city.to_owned());
    whole.display().to_string()
}

/// The view that a city was left with.
pub fn last_view(city: &Path) -> Option<PathKey> {
    let view = read(&file()?).remove(&name(city))?.view;
    let numbers = view.eye.iter().chain(&view.look);
    (numbers.into_iter().all(|value| value.is_finite()) && view.eye != view.look).then_some(view)
}

/// Remembers the view that a city is left with. What cannot be written is not remembered.
pub fn remember_view(city: &Path, view: PathKey) {
    let Some(path) = file() else { return };
    let mut views = read(&path);
    if views.len() >= MAX_CITIES {
        // Those whose folders are gone make room.
        views.retain(|city, _| Path::new(city).is_dir());
    }
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let at_s = now.map_or(0, |now| now.as_secs());
    views.insert(name(city), Left { view, at_s });
    let Ok(text) = serde_json::to_string_pretty(&views) else {
        return;
    };
    let beside = path.with_extension("json.partial");
    let written = path.parent().map(std::fs::create_dir_all).transpose().is_ok()
        && std::fs::write(&beside, text).is_ok();
    if written {
        let _ = std::fs::rename(&beside, &path);
    }
}
