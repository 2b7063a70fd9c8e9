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
        let file = File::open(folder).map_err(CityError::file(folder))?;
        match file.lock() {
            Ok(()) => Ok(Self { _folder: Some(file) }),
            // A file system without locks: as good as it gets.
            Err(error) if error.kind() == std::io::ErrorKind::Unsupported => Ok(Self { _folder: None }),
            Err(error) => Err(CityError::file(folder)(error)),
        }
    }
}
