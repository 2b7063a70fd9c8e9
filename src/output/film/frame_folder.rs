//! The folder of a film's frames: files that appear whole, so that a film that was stopped goes on where it was.

use std::fs::{self, File, TryLockError};
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::output::{OutputError, write_exr, write_png};

/// What a film's frames hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum FrameKind {
    /// 8-bit sRGB.
    #[default]
    Png,
    /// Linear radiance, before exposure and tone mapping.
    Exr,
}

impl FrameKind {
    fn ending(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Exr => "exr",
        }
    }
}

/// A frame's pixels, rows from the top.
#[derive(Clone, Copy, Debug)]
pub enum FramePixels<'a> {
    /// 8-bit sRGB, RGBA.
    Display(&'a [u8]),
    /// Linear RGB.
    Radiance(&'a [[f32; 3]]),
}

/// The frames of one film.
pub struct FrameFolder {
    folder: PathBuf,
    kind: FrameKind,
    /// Locked as long as this lives: one film at a time is made in a folder.
    _key: File,
}

/// What the frames are of: a film of other parameters begins anew.
const KEY_FILE: &str = "film.key";
/// A video of the frames while it is made.
const VIDEO: &str = "film.partial";
/// After the ending of a frame that is being written.
const PARTIAL: &str = ".partial";

impl FrameFolder {
    /// Opens a folder for frames of a film that `key` tells from others. Frames of another film are removed.
    ///
    /// # Errors
    /// When the folder holds other things, or cannot be written.
    pub fn open(folder: &Path, key: &str, kind: FrameKind) -> Result<Self, OutputError> {
        let error = |path: &Path, why: String| OutputError {
            path: path.to_owned(),
            why,
        };
        fs::create_dir_all(folder).map_err(|why| error(folder, why.to_string()))?;
        let key_path = folder.join(KEY_FILE);
        if !frames_in(folder)?.is_empty() && !key_path.is_file() {
            return Err(error(
                folder,
                format!("holds frames without {KEY_FILE}, which tells their film; name an empty folder"),
            ));
        }
        if key_path.is_symlink() {
            return Err(error(&key_path, "is a link; name an empty folder".to_owned()));
        }
        let mut options = File::options();
        options.create(true).truncate(false).read(true).write(true);
        let mut key_file = options
            .open(&key_path)
            .map_err(|why| error(&key_path, why.to_string()))?;
        // A file system without locks: as good as it gets.
        if let Err(TryLockError::WouldBlock) = key_file.try_lock() {
            return Err(error(
                folder,
                "another film is being made there; wait for it, or name another place".to_owned(),
            ));
        }
        let mut known = String::new();
        // What is no text is no key.
        let _ = key_file.read_to_string(&mut known);
        if known != key {
            for path in frames_in(folder)? {
                fs::remove_file(&path).map_err(|why| error(&path, why.to_string()))?;
            }
            fs::write(&key_path, key).map_err(|why| error(&key_path, why.to_string()))?;
        }
        Ok(Self {
            folder: folder.to_owned(),
            kind,
            _key: key_file,
        })
    }

    /// The file of a frame.
    pub fn path(&self, frame: u32) -> PathBuf {
        self.folder.join(format!("{frame:06}.{}", self.kind.ending()))
    }

    /// Whether a frame is there.
    pub fn has(&self, frame: u32) -> bool {
        // A link is no frame of ours.
        let data = fs::symlink_metadata(self.path(frame));
        data.is_ok_and(|data| data.is_file())
    }

    /// Puts a frame in.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn put(&self, frame: u32, size: [u32; 2], pixels: FramePixels<'_>) -> Result<(), OutputError> {
        let path = self.path(frame);
        let beside = path.with_extension(format!("{}{PARTIAL}", self.kind.ending()));
        match pixels {
            FramePixels::Display(rgba) => write_png(&beside, size, rgba)?,
            FramePixels::Radiance(radiance) => write_exr(&beside, size, radiance)?,
        }
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
        self.folder.join(format!("%06d.{}", self.kind.ending()))
    }

    /// Where a video of them is made, before it takes its place.
    pub fn video(&self) -> PathBuf {
        self.folder.join(VIDEO)
    }

    /// Removes the frames, which are in a video, and the folder.
    ///
    /// # Errors
    /// When one cannot be removed.
    pub fn remove(self) -> Result<(), OutputError> {
        for path in frames_in(&self.folder)?
            .into_iter()
            .chain([self.folder.join(KEY_FILE)])
        {
            fs::remove_file(&path).map_err(|why| OutputError {
                path,
                why: why.to_string(),
            })?;
        }
        // What somebody else put there stays.
        let _ = fs::remove_dir(&self.folder);
        Ok(())
    }
}

/// Six digits, also of one that was being written.
fn is_frame_name(name: &str) -> bool {
    let Some((number, ending)) = name.split_once('.') else {
        return false;
    };
    number.len() >= 6
        && number.bytes().all(|byte| byte.is_ascii_digit())
        && ["png", "exr"].contains(&ending.strip_suffix(PARTIAL).unwrap_or(ending))
}

/// The frames in a folder, and what a stopped encoder left.
///
/// # Errors
/// When it holds anything else than a film.
fn frames_in(folder: &Path) -> Result<Vec<PathBuf>, OutputError> {
    let error = |why: String| OutputError {
        path: folder.to_owned(),
        why,
    };
    let mut frames = Vec::new();
    for entry in fs::read_dir(folder)
        .map_err(|why| error(why.to_string()))?
        .flatten()
    {
        let name = entry.file_name();
        if name == VIDEO || name.to_str().is_some_and(is_frame_name) {
            frames.push(entry.path());
        } else if name != KEY_FILE {
            return Err(error(format!(
                "holds {}, which is no frame of a film; name an empty folder",
                name.display()
            )));
        }
    }
    Ok(frames)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_stay_for_the_same_film_and_go_for_another() -> Result<(), Box<dyn std::error::Error>> {
        let folder = std::env::temp_dir().join(format!("rilievo-frames-{}", std::process::id()));
        let open = |key: &str| FrameFolder::open(&folder, key, FrameKind::Png);
        let frames = open("a")?;
        frames.put(3, [1, 1], FramePixels::Display(&[1, 2, 3, 255]))?;
        assert!(open("a").is_err(), "two films in one folder");
        drop(frames);
        assert!(open("a")?.has(3));
        assert!(!open("b")?.has(3));
        fs::write(folder.join("thesis.doc"), "mine")?;
        assert!(open("c").is_err());
        assert!(folder.join("thesis.doc").is_file());
        Ok(fs::remove_dir_all(&folder)?)
    }
}
