//! One import into a place at a time: the next one is told, and does nothing.

use std::fs::{File, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

use super::CityError;
use super::update::is_at;

/// How often a lock that was taken away while it was waited for is tried again.
const MAX_TRIES: u32 = 100;

/// The place of a city locked against other imports, as long as this lives. The system lets go of it when the program is killed.
pub struct ImportLock {
    file: File,
    path: PathBuf,
}

impl ImportLock {
    /// Locks `NAME.lock` beside the city.
    ///
    /// # Errors
    /// `Busy` when another import holds it.
    pub fn acquire(target: &Path) -> Result<Self, CityError> {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(".lock");
        let path = target.with_file_name(name);
        for _ in 0..MAX_TRIES {
            let is_link = std::fs::symlink_metadata(&path).is_ok_and(|data| !data.is_file());
            if is_link {
                return Err(CityError::Occupied { path });
            }
            let file = File::options()
                .create(true)
                .truncate(false)
                .read(true)
                .write(true)
                .open(&path);
            let mut file = file.map_err(CityError::file(&path))?;
            if !is_lock(&mut file).map_err(CityError::file(&path))? {
                return Err(CityError::Occupied { path });
            }
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => {
                    let mut who = String::new();
                    // Whatever it says: it is for the user alone.
                    let _ = Read::by_ref(&mut file).take(32).read_to_string(&mut who);
                    return Err(CityError::Busy {
                        path: target.to_owned(),
                        process: who.trim().to_owned(),
                    });
                }
                // A file system without locks: as good as it gets.
                Err(TryLockError::Error(_)) | Ok(()) => {}
            }
            // The one before may have taken it away meanwhile.
            if !is_at(&file, &path) {
                continue;
            }
            let written = file
                .set_len(0)
                .and_then(|()| file.rewind())
                .and_then(|()| write!(file, "{}", std::process::id()));
            written.map_err(CityError::file(&path))?;
            return Ok(Self { file, path });
        }
        Err(CityError::Busy {
            path: target.to_owned(),
            process: String::new(),
        })
    }
}

/// Whether a file holds what a lock holds: the number of a process, or nothing yet. Anything else is somebody's own.
fn is_lock(file: &mut File) -> std::io::Result<bool> {
    let mut held = Vec::new();
    Read::by_ref(file).take(32).read_to_end(&mut held)?;
    file.rewind()?;
    Ok(held.len() <= 10 && held.iter().all(u8::is_ascii_digit))
}

impl Drop for ImportLock {
    fn drop(&mut self) {
        // While it is still held, so that nobody else's is taken away.
        let _ = std::fs::remove_file(&self.path);
        let _ = self.file.unlock();
    }
}
