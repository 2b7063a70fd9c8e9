//! The folder a city is made in, beside its place, until it is whole.
//!
//! A killed import leaves `NAME.partial`; the same import run again goes on from its finished tiles.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::city_files::{COMMITTED, PARTIAL, PICTURES, enclosing_city, foreign, is_city, open_plain};
use super::durable::{sync, write};
use super::import_lock::ImportLock;
use super::layer::Layer;
use super::rules_file::{FACADES, FACADES_BEFORE};
use super::update::CityLock;
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
const REPLACED: &str = "rilievo replaced";
/// The marker while it is written.
const NEW_KEY: &str = "import.cache_key.partial";
/// What a city folder holds, beside its layers' folders.
const FILES: [&str; 9] = [
    "city.toml",
    "buildings.gpkg",
    FACADES,
    FACADES_BEFORE,
    PICTURES,
    PARTIAL,
    COMMITTED,
    CACHE_KEY,
    NEW_KEY,
];
/// What the staging folder may hold besides.
const JOURNAL: &str = "buildings.gpkg-journal";

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
        if let Some(city) = enclosing_city(&target) {
            return Err(CityError::Inside { path: target, city });
        }
        if let Some(parent) = target.parent().filter(|parent| !parent.as_os_str().is_empty()) {
            fs::create_dir_all(parent).map_err(CityError::file(parent))?;
        }
        let lock = ImportLock::acquire(&target)?;
        let [folder, previous] = beside(&target);
        // An exchange that was stopped in the middle: before the new city was in place, or after.
        if is_city(&previous) && has_marker(&previous, REPLACED) {
            if target.exists() {
                refuse_foreign(&previous, &FILES)?;
                remove_marked(&previous)?;
            } else {
                fs::rename(&previous, &target).map_err(CityError::file(&target))?;
            }
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
            refuse_foreign(&folder, &[FILES.as_slice(), &[JOURNAL]].concat())?;
            // At most the marker was begun.
            let is_empty = fs::read_dir(&folder).is_ok_and(|mut entries| {
                entries.all(|entry| entry.is_ok_and(|entry| entry.file_name() == NEW_KEY))
            });
            if !has_marker(&folder, MARK) && !is_empty {
                // No import left it: a city that somebody moved there.
                return Err(CityError::Foreign { path: folder });
            }
            if !holds(&marker, cache_key) {
                remove_marked(&folder)?;
            }
        }
        fs::create_dir_all(&folder).map_err(CityError::file(&folder))?;
        write_marker(&folder, cache_key)?;
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
            write_marker(&self.target, REPLACED)?;
            sync(&self.folder)?;
            exchange(&self.folder, &self.target)?;
            // The new one is there before the old one goes.
            sync(parent)?;
            remove_marked(&self.folder)?;
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

/// Whether a file holds a text and no more.
fn holds(path: &Path, text: &str) -> bool {
    let mut known = Vec::new();
    let limit = text.len() as u64 + 1;
    let read = open_plain(path).is_ok_and(|file| file.take(limit).read_to_end(&mut known).is_ok());
    read && known == text.as_bytes()
}

/// Whether a folder's marker begins so.
fn has_marker(folder: &Path, begin: &str) -> bool {
    let mut known = Vec::new();
    let file = open_plain(&folder.join(CACHE_KEY));
    let read = file.is_ok_and(|file| file.take(begin.len() as u64).read_to_end(&mut known).is_ok());
    read && known == begin.as_bytes()
}

/// Writes a folder's marker in one step.
fn write_marker(folder: &Path, text: &str) -> Result<(), CityError> {
    let (marker, partial) = (folder.join(CACHE_KEY), folder.join(NEW_KEY));
    let written = write(&partial, text.as_bytes()).and_then(|()| fs::rename(&partial, &marker));
    written.map_err(|error| {
        let _ = fs::remove_file(&partial);
        CityError::file(&marker)(error)
    })
}

/// Removes a folder of an import, its marker last: whenever this is stopped, what is left can be removed too.
fn remove_marked(folder: &Path) -> Result<(), CityError> {
    for entry in fs::read_dir(folder).map_err(CityError::file(folder))? {
        let entry = entry.map_err(CityError::file(folder))?;
        let path = entry.path();
        let removed = match entry.file_type() {
            _ if entry.file_name() == CACHE_KEY => continue,
            Ok(kind) if kind.is_dir() => fs::remove_dir_all(&path),
            _ => fs::remove_file(&path),
        };
        removed.map_err(CityError::file(&path))?;
    }
    fs::remove_dir_all(folder).map_err(CityError::file(folder))
}

/// Refuses a folder that holds what no import made, besides `names` at its top: it would be lost.
fn refuse_foreign(folder: &Path, names: &[&str]) -> Result<(), CityError> {
    match foreign(folder, names)? {
        Some(path) => Err(CityError::Foreign { path }),
        None => Ok(()),
    }
}

/// How often the file of a dataset was changed: its change counter (SQLite file format, 1.3.7).
pub fn changes_of(dataset: &Path) -> Option<u32> {
    let mut header = [0; 28];
    open_plain(dataset).ok()?.read_exact(&mut header).ok()?;
    let [.., a, b, c, d] = header;
    Some(u32::from_be_bytes([a, b, c, d]))
}

/// Refuses to replace a footprint dataset that was changed after the city was made (its manifest is written last), or whose
/// city was updated.
fn refuse_edited(target: &Path) -> Result<(), CityError> {
    let changed = |name: &str| fs::metadata(target.join(name)).and_then(|file| file.modified());
    let (Ok(map), Ok(manifest)) = (changed("buildings.gpkg"), changed("city.toml")) else {
        return Ok(());
    };
    // Its manifest may have been edited after it.
    let is_changed = City::open(target).is_ok_and(|city| {
        let made = city.manifest();
        let changes = changes_of(&city.footprint_dataset_path());
        made.generation > 0 || (made.dataset_changes.is_some() && made.dataset_changes != changes)
    });
    if map <= manifest && !is_changed {
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
