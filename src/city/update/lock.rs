//! One update at a time: the next one waits.

use std::fs::File;
use std::path::Path;

use crate::city::CityError;

/// A city folder locked against other updates, as long as this lives. The system lets go of it when the program is killed.
pub struct CityLock {
    _folder: Option<File>,
}

impl CityLock {
    /// Waits until nobody else updates the city.
    ///
    /// # Errors
    /// When the folder cannot be opened.
    pub fn acquire(folder: &Path) -> Result<Self, CityError> {
        // Only here can a folder be opened like a file.
        if !cfg!(unix) {
            return Ok(Self { _folder: None });
        }
        loop {
            let file = File::open(folder).map_err(CityError::file(folder))?;
            // A file system without locks for folders: as good as it gets.
            if file.lock().is_err() {
                return Ok(Self { _folder: None });
            }
            // An import may have put another folder in its place meanwhile.
            if is_at(&file, folder) {
                return Ok(Self { _folder: Some(file) });
            }
        }
    }
}

/// Whether an open file or folder is the one at a path.
#[cfg(unix)]
pub fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let of = |data: std::io::Result<std::fs::Metadata>| data.ok().map(|data| (data.dev(), data.ino()));
    of(file.metadata()) == of(std::fs::metadata(path))
}

#[cfg(not(unix))]
pub fn is_at(_: &File, _: &Path) -> bool {
    true
}
