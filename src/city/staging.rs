//! The folder a city is made in, beside its place, until it is whole.
//!
//! A killed import leaves `NAME.partial`; the same import run again goes on from its finished tiles.

use std::fs;
use std::path::{Path, PathBuf};

use super::city_files::{MAX_TEXT, foreign, read_plain_text};
use super::durable::sync;
use super::import_lock::ImportLock;
use super::layer::Layer;
use super::rules_file::FACADES;
use super::update::{COMMITTED, CityLock, PARTIAL};
use super::{City, CityError};

/// A city in the making.
pub struct Staging {
    folder: PathBuf,
    target: PathBuf,
    _lock: ImportLock,
}

/// In the staging folder, and in an old city while it is replaced: marks a folder that may be removed. It begins with `MARK`.
const CACHE_KEY: &str = "import.cache_key";
const MARK: &str = "rilievo ";
/// What a city folder holds, beside its layers' folders.
const FILES: [&str; 6] = [
    "city.toml",
    "buildings.gpkg",
    FACADES,
    PARTIAL,
    COMMITTED,
    CACHE_KEY,
];
/// What the staging folder may hold besides.
const STAGED: [&str; 8] = [
    "city.toml",
    "buildings.gpkg",
    FACADES,
    PARTIAL,
    COMMITTED,
    CACHE_KEY,
    "buildings.gpkg-journal",
    "buildings.gpkg-wal",
];

/// The folder beside a city that it is made in, and the one that holds an old city for a moment where folders cannot be exchanged.
pub fn beside(target: &Path) -> [PathBuf; 2] {
    [".partial", ".previous"].map(|ending| {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(ending);
        target.with_file_name(name)
    })
}

impl Staging {
    /// Opens the staging folder of `target`. Tiles left by an import with the same `cache_key` (its options and its
    /// sources' files) are kept, others removed. What no import made is never removed.
    pub fn open(target: &Path, cache_key: &str) -> Result<Self, CityError> {
        if target.file_name().is_none_or(|name| name.is_empty()) {
            return Err(CityError::NoFolderName {
                path: target.to_owned(),
            });
        }
        // A link stands for the folder that it names.
        let target = match fs::symlink_metadata(target) {
            Ok(data) if data.is_symlink() => fs::canonicalize(target).map_err(CityError::file(target))?,
            _ => target.to_owned(),
        };
        let lock = ImportLock::acquire(&target)?;
        let [folder, previous] = beside(&target);
        // An exchange that was stopped in the middle.
        if !target.exists() && is_city(&previous) {
            fs::rename(&previous, &target).map_err(CityError::file(&target))?;
        }
        if fs::symlink_metadata(&target).is_ok() {
            let is_empty =
                target.is_dir() && fs::read_dir(&target).is_ok_and(|mut entries| entries.next().is_none());
            if !is_empty && !is_city(&target) {
                return Err(CityError::Occupied { path: target });
            }
            refuse_foreign(&target, &FILES)?;
        }
        refuse_edited(&target)?;
        let marker = folder.join(CACHE_KEY);
        if fs::symlink_metadata(&folder).is_ok() {
            refuse_foreign(&folder, &STAGED)?;
            let known = read_plain_text(&marker, MAX_TEXT).unwrap_or_default();
            let is_empty = fs::read_dir(&folder).is_ok_and(|mut entries| entries.next().is_none());
            if !known.starts_with(MARK) && !is_empty {
                // No import left it: a city that somebody moved there.
                return Err(CityError::Foreign { path: folder });
            }
            if known != cache_key {
                fs::remove_dir_all(&folder).map_err(CityError::file(&folder))?;
            }
        }
        fs::create_dir_all(&folder).map_err(CityError::file(&folder))?;
        fs::write(&marker, cache_key).map_err(CityError::file(&marker))?;
        for layer in Layer::ALL {
            let path = folder.join(layer.name()).join("0");
            fs::create_dir_all(&path).map_err(CityError::file(&path))?;
        }
        Ok(Self {
            folder,
            target,
            _lock: lock,
        })
    }

    /// Where to write.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Makes the city durable and puts it in place in one step, in exchange for an older one.
    pub fn finish(self) -> Result<(), CityError> {
        // No update in between.
        let _lock = match self.target.is_dir() {
            true => Some(CityLock::acquire(&self.target)?),
            false => None,
        };
        refuse_edited(&self.target)?;
        let parent = self
            .target
            .parent()
            .filter(|parent| !parent.as_os_str().is_empty());
        let parent = parent.unwrap_or(Path::new("."));
        if is_city(&self.target) {
            // So that the old city can be removed, whenever this is stopped.
            let marker = self.target.join(CACHE_KEY);
            fs::write(&marker, format!("{MARK}replaced")).map_err(CityError::file(&marker))?;
            sync(&self.folder)?;
            exchange(&self.folder, &self.target)?;
            // The new one is there before the old one goes.
            sync(parent)?;
            fs::remove_dir_all(&self.folder).map_err(CityError::file(&self.folder))?;
        } else {
            sync(&self.folder)?;
            if self.target.is_dir() {
                fs::remove_dir(&self.target).map_err(CityError::file(&self.target))?;
            }
            fs::rename(&self.folder, &self.target).map_err(CityError::file(&self.target))?;
        }
        let marker = self.target.join(CACHE_KEY);
        fs::remove_file(&marker).map_err(CityError::file(&marker))?;
        sync(parent)
    }
}

/// Whether a folder has a manifest that this program wrote, of whatever format.
fn is_city(folder: &Path) -> bool {
    let text = read_plain_text(&folder.join("city.toml"), MAX_TEXT).unwrap_or_default();
    let Ok(manifest) = text.parse::<toml::Table>() else {
        return false;
    };
    ["format", "crs", "tile_texels", "grid"]
        .iter()
        .all(|key| manifest.contains_key(*key))
}

/// Refuses a folder that holds what no import made, besides `names` at its top: it would be lost.
fn refuse_foreign(folder: &Path, names: &[&str]) -> Result<(), CityError> {
    match foreign(folder, names)? {
        Some(path) => Err(CityError::Foreign { path }),
        None => Ok(()),
    }
}

/// Refuses to replace a footprint dataset that was changed after the city was made (its manifest is written last), or whose
/// city was updated.
fn refuse_edited(target: &Path) -> Result<(), CityError> {
    let changed = |name: &str| fs::metadata(target.join(name)).and_then(|file| file.modified());
    let (Ok(map), Ok(manifest)) = (changed("buildings.gpkg"), changed("city.toml")) else {
        return Ok(());
    };
    let is_updated = City::open(target).is_ok_and(|city| city.manifest().generation > 0);
    if map <= manifest && !is_updated {
        return Ok(());
    }
    Err(CityError::Edited {
        path: target.join("buildings.gpkg"),
    })
}

/// Swaps the new city and the old one, in one step where the system can.
fn exchange(new: &Path, old: &Path) -> Result<(), CityError> {
    #[cfg(target_os = "linux")]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        if renameat_with(CWD, new, CWD, old, RenameFlags::EXCHANGE).is_ok() {
            return Ok(());
        }
    }
    // Thin file systems cannot: three renames, each of which leaves both cities whole under some name.
    let [_, aside] = beside(old);
    fs::rename(old, &aside).map_err(CityError::file(old))?;
    fs::rename(new, old).map_err(CityError::file(old))?;
    fs::rename(&aside, new).map_err(CityError::file(new))
}
