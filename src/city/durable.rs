//! Writes files that are nobody else's, and makes what was written durable.

use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

use super::CityError;

/// Makes a file to write in place of whatever had its name: a link that somebody left there would lead the writer elsewhere.
///
/// # Errors
/// When it cannot be made.
pub fn create(path: &Path) -> std::io::Result<File> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    File::options().write(true).create_new(true).open(path)
}

/// Writes a whole file so.
///
/// # Errors
/// When it cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    create(path)?.write_all(bytes)
}

/// Flushes the file system that holds the folder: one call instead of one per tile.
pub fn sync(folder: &Path) -> Result<(), CityError> {
    let handle = fs::File::open(folder).map_err(CityError::file(folder))?;
    #[cfg(target_os = "linux")]
    rustix::fs::syncfs(&handle).map_err(|error| CityError::file(folder)(error.into()))?;
    #[cfg(not(target_os = "linux"))]
    let _ = handle.sync_all();
    Ok(())
}
