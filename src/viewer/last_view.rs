//! The last view of every city, remembered between windows: one small file in the user's state folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::output::PathKey;

/// Views by the city's folder.
type Views = BTreeMap<String, PathKey>;

/// Cities remembered.
const MAX_CITIES: usize = 200;

/// The file: in `XDG_STATE_HOME`, or `.local/state` of the home folder.
fn file() -> Option<PathBuf> {
    let state = std::env::var_os("XDG_STATE_HOME")
        .map(PathBuf::from)
        .filter(|path| path.is_absolute());
    let home = || std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/state"));
    Some(state.or_else(home)?.join("rilievo").join("views.json"))
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
    let view = read(&file()?).remove(&name(city))?;
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
    views.insert(name(city), view);
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
