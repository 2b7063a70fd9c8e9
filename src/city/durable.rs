//! Makes what was written durable.

use std::fs;
use std::path::Path;

use super::CityError;

/// Flushes the file system that holds the folder: one call instead of one per tile.
pub fn sync(folder: &Path) -> Result<(), CityError> {
    let handle = fs::File::open(folder).map_err(CityError::file(folder))?;
    #[cfg(target_os = "linux")]
    rustix::fs::syncfs(&handle).map_err(|error| CityError::file(folder)(error.into()))?;
    #[cfg(not(target_os = "linux"))]
    let _ = handle.sync_all();
    Ok(())
}
