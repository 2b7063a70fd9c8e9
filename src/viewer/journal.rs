//! A journal of the frames shown, a JSON object a line: for measuring, and for tests that drive the window.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::ViewerError;

/// One frame.
#[derive(Clone, Debug, Serialize)]
pub struct FrameRecord {
    /// Seconds since the program's start.
    pub time_s: f64,
    /// Eye, metres in the city's CRS.
    pub eye: [f64; 3],
    /// Direction of view.
    pub forward: [f64; 3],
    /// Vertical field of view, radians.
    pub fov_y: f64,
    /// Window, pixels.
    pub window: [u32; 2],
    /// Frame, pixels.
    pub frame: [u32; 2],
    /// Samples so far.
    pub samples: u32,
    /// Milliseconds that the frame took to draw.
    pub frame_ms: f64,
    /// The sun's instant, RFC 3339.
    pub sun_time: String,
    /// Generation of the city.
    pub generation: u64,
    /// The building selected, 0 without one.
    pub selected: u32,
    /// Edits made that can be taken back.
    pub edits: usize,
    /// Keys of the flight.
    pub path_keys: usize,
    /// Length measured, metres.
    pub measured_m: f64,
}

/// An open journal.
pub struct Journal {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Journal {
    /// Begins a file anew.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn create(path: &Path) -> Result<Self, ViewerError> {
        let file = File::create(path).map_err(|error| file_error(path, &error))?;
        Ok(Self {
            path: path.to_owned(),
            file: BufWriter::new(file),
        })
    }

    /// Adds a line.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&mut self, record: &FrameRecord) -> Result<(), ViewerError> {
        let line = serde_json::to_string(record).unwrap_or_default();
        writeln!(self.file, "{line}")
            .and_then(|()| self.file.flush())
            .map_err(|error| file_error(&self.path, &error))
    }
}

fn file_error(path: &Path, error: &std::io::Error) -> ViewerError {
    ViewerError::File {
        path: path.to_owned(),
        why: error.to_string(),
    }
}
