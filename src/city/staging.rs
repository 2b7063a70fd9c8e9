//! The folder a city is made in, beside its place, until it is whole.
//!
//! A killed import leaves `NAME.partial`; the same import run again goes on from its finished tiles.

use std::fs;
use std::path::{Path, PathBuf};

use super::durable::sync;
use super::layer::Layer;
use super::rules_file::FACADES;
use super::update::{COMMITTED, CityLock, PARTIAL};
use super::{City, CityError};

/// A city in the making.
pub struct Staging {
    folder: PathBuf,
    target: PathBuf,
}

const CACHE_KEY: &str = "import.cache_key";
/// What a city folder holds, beside its layers' folders.
const FILES: [&str; 5] = ["city.toml", "buildings.gpkg", FACADES, PARTIAL, COMMITTED];

impl Staging {
    /// Opens the staging folder of `target`. Tiles left by an import with the same `cache_key` (its options and its
    /// sources' sizes and times) are kept, others removed.
    pub fn open(target: &Path, cache_key: &str) -> Result<Self, CityError> {
        if target.exists() && !target.join("city.toml").is_file() {
            let occupied =
                !target.is_dir() || fs::read_dir(target).is_ok_and(|mut entries| entries.next().is_some());
            if occupied {
                return Err(CityError::Occupied {
                    path: target.to_owned(),
                });
            }
        }
        refuse_foreign(target, &[])?;
        refuse_edited(target)?;
        let mut name = target.file_name().unwrap_or_default().to_owned();
        if name.is_empty() {
            return Err(CityError::NoFolderName {
                path: target.to_owned(),
            });
        }
        name.push(".partial");
        let folder = target.with_file_name(name);
        let cache_key_path = folder.join(CACHE_KEY);
        refuse_foreign(&folder, &[CACHE_KEY, "buildings.gpkg-journal"])?;
        if folder.exists() && fs::read_to_string(&cache_key_path).ok().as_deref() != Some(cache_key) {
            fs::remove_dir_all(&folder).map_err(CityError::file(&folder))?;
        }
        for layer in Layer::ALL {
            let path = folder.join(layer.name()).join("0");
            fs::create_dir_all(&path).map_err(CityError::file(&path))?;
        }
        fs::write(&cache_key_path, cache_key).map_err(CityError::file(&cache_key_path))?;
        Ok(Self {
            folder,
            target: target.to_owned(),
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
        let cache_key = self.folder.join(CACHE_KEY);
        fs::remove_file(&cache_key).map_err(CityError::file(&cache_key))?;
        sync(&self.folder)?;
        if self.target.join("city.toml").is_file() {
            exchange(&self.folder, &self.target)?;
            fs::remove_dir_all(&self.folder).map_err(CityError::file(&self.folder))?;
        } else {
            if self.target.is_dir() {
                fs::remove_dir(&self.target).map_err(CityError::file(&self.target))?;
            }
            fs::rename(&self.folder, &self.target).map_err(CityError::file(&self.target))?;
        }
        let parent = self
            .target
            .parent()
            .filter(|parent| !parent.as_os_str().is_empty());
        sync(parent.unwrap_or(Path::new(".")))
    }
}

/// Refuses a folder that holds what no import made, besides `more`: it would be lost.
fn refuse_foreign(folder: &Path, more: &[&str]) -> Result<(), CityError> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Ok(());
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_layer = Layer::ALL.iter().any(|layer| name == layer.name());
        let is_file = FILES.iter().chain(more).any(|file| name == **file);
        if !is_layer && !is_file {
            return Err(CityError::Foreign { path: entry.path() });
        }
    }
    Ok(())
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
    // Tin file systems cannot: three renames, each of which leaves both cities whole under some name.
    let mut name = old.file_name().unwrap_or_default().to_owned();
    name.push(".previous");
    let aside = old.with_file_name(name);
    fs::rename(old, &aside).map_err(CityError::file(old))?;
    fs::rename(new, old).map_err(CityError::file(old))?;
    fs::rename(&aside, new).map_err(CityError::file(new))
}
