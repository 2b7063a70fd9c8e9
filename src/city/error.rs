//! Why a city could not be written or read.

use std::path::PathBuf;

use thiserror::Error;

use crate::source::SourceError;
use crate::space::CrsError;

/// A city folder could not be made or opened.
#[derive(Debug, Error)]
pub enum CityError {
    /// A source file was refused.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The city's CRS cannot be used.
    #[error(transparent)]
    Crs(#[from] CrsError),
    /// A file could not be read or written.
    #[error("{}: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        why: String,
    },
    /// A tile is damaged.
    #[error("{}: is not a tile of this city ({why}); run the import again", path.display())]
    Tile {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The folder is no city.
    #[error("{}: is not a city ({why}); make one with: rilievo import --terrain .. --buildings .. --out {}", path.display(), path.display())]
    NotACity {
        /// The folder.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The sources do not make a city together.
    #[error("{what}; {advice}")]
    Unfit {
        /// What is wrong.
        what: String,
        /// What to do.
        advice: String,
    },
}

impl CityError {
    /// Wraps an I/O error with its file.
    pub fn file(path: &std::path::Path) -> impl FnOnce(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |error| Self::File {
            path,
            why: error.to_string(),
        }
    }
}
