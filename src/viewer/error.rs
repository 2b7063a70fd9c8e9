//! Why there is no window.

use std::path::PathBuf;

use thiserror::Error;

/// The window could not be opened or drawn.
#[derive(Debug, Error)]
pub enum ViewerError {
    /// No display.
    #[error("no window can be opened ({why})")]
    NoWindow {
        /// What the system said.
        why: String,
    },
    /// The device failed.
    #[error(transparent)]
    Render(#[from] crate::output::RenderError),
    /// A time cannot be used.
    #[error(transparent)]
    Sun(#[from] crate::space::SunError),
    /// A file could not be written.
    #[error("{}: cannot be written ({why})", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        why: String,
    },
}
