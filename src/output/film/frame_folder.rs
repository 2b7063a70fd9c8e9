//! The folder of a film's frames: PNG files that appear whole, so that a film that was stopped goes on where it was.

use std::fs;
use std::path::{Path, PathBuf};

use crate::output::{OutputError, write_png};

/// The frames of one film.
pub struct FrameFolder {
    folder: PathBuf,
}

/// What the frames are of: a film of other parameters begins anew.
const KEY_FILE: &str = "film.key";

impl FrameFolder {
    /// Opens a folder for frames of a film that `key` tells from others. Frames of another film are removed.
    ///
    /// # Errors
    /// When the folder holds other things, or cannot be written.
    pub fn open(folder: &Path, key: &str) -> Result<Self, OutputError> {
        let error = |path: &Path, why: String| OutputError {
            path: path.to_owned(),
            why,
        };
        fs::create_dir_all(folder).map_err(|why| error(folder, why.to_string()))?;
        let mut frames = Vec::new();
        for entry in fs::read_dir(folder)
            .map_err(|why| error(folder, why.to_string()))?
            .flatten()
        {
            let (path, name) = (entry.path(), entry.file_name());
            let is_frame = name.to_str().is_some_and(is_frame_name);
            if !is_frame && name != KEY_FILE {
                return Err(error(
                    folder,
                    format!(
                        "holds {}, which is no frame of a film; name an empty folder",
                        name.display()
                    ),
                ));
            }
            if is_frame {
                frames.push(path);
            }
        }
        let key_path = folder.join(KEY_FILE);
        let known = fs::read_to_string(&key_path).ok();
        if known.is_none() && !frames.is_empty() {
            return Err(error(
                folder,
                format!("holds frames without {KEY_FILE}, which tells their film; name an empty folder"),
            ));
        }
        if known.as_deref() != Some(key) {
            for path in frames {
                fs::remove_file(&path).map_err(|why| error(&path, why.to_string()))?;
            }
            fs::write(&key_path, key).map_err(|why| error(&key_path, why.to_string()))?;
        }
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    /// The file of a frame.
    pub fn path(&self, frame: u32) -> PathBuf {
        self.folder.join(format!("{frame:06}.png"))
    }

    /// Whether a frame is there.
    pub fn has(&self, frame: u32) -> bool {
        self.path(frame).is_file()
    }

    /// Puts a frame in: 8-bit RGBA, rows from the top.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn put(&self, frame: u32, size: [u32; 2], rgba: &[u8]) -> Result<(), OutputError> {
        let path = self.path(frame);
        let beside = path.with_extension("png.partial");
        write_png(&beside, size, rgba)?;
        // A frame that is there is whole, also after the power failed.
        let durable = fs::File::open(&beside).and_then(|file| file.sync_all());
        durable
            .and_then(|()| fs::rename(&beside, &path))
            .map_err(|why| OutputError {
                path,
                why: why.to_string(),
            })
    }

    /// What ffmpeg reads: a pattern of file names.
    pub fn pattern(&self) -> PathBuf {
        self.folder.join("%06d.png")
    }

    /// Removes the folder, whose frames are in a video.
    ///
    /// # Errors
    /// When it cannot be removed.
    pub fn remove(self) -> Result<(), OutputError> {
        fs::remove_dir_all(&self.folder).map_err(|why| OutputError {
            path: self.folder,
            why: why.to_string(),
        })
    }
}

/// Six digits, also of one that was being written.
fn is_frame_name(name: &str) -> bool {
    let Some((number, ending)) = name.split_once('.') else {
        return false;
    };
    number.len() >= 6
        && number.bytes().all(|byte| byte.is_ascii_digit())
        && ["png", "png.partial"].contains(&ending)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_stay_for_the_same_film_and_go_for_another() -> Result<(), Box<dyn std::error::Error>> {
        let folder = std::env::temp_dir().join(format!("rilievo-frames-{}", std::process::id()));
        let frames = FrameFolder::open(&folder, "a")?;
        frames.put(3, [1, 1], &[1, 2, 3, 255])?;
        assert!(FrameFolder::open(&folder, "a")?.has(3));
        assert!(!FrameFolder::open(&folder, "b")?.has(3));
        fs::write(folder.join("thesis.doc"), "mine")?;
        assert!(FrameFolder::open(&folder, "c").is_err());
        assert!(folder.join("thesis.doc").is_file());
        Ok(fs::remove_dir_all(&folder)?)
    }
}
