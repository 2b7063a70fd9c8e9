//! Why a lens could not be read.

use std::path::PathBuf;

use thiserror::Error;

/// A prescription could not be read, or is no lens.
#[derive(Debug, Error)]
pub enum LensError {
    /// The file could not be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Neither a built-in name nor a file.
    #[error(
        "{name}: neither a built-in lens ({known}) nor a file; `rilievo lens list` describes the built-in ones"
    )]
    Unknown {
        /// What was asked for.
        name: String,
        /// Names of the built-in lenses.
        known: String,
    },
    /// Not one of the formats that are read.
    #[error(
        "{path}: its ending names no lens format; give .toml, .csv, .zmx (Zemax), .seq (CODE V) or .dat (pbrt)"
    )]
    Format {
        /// The file.
        path: PathBuf,
    },
    /// A line or field is not as its format has it.
    #[error("{path}: {what}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// What is wrong and where.
        what: String,
    },
    /// Its stop is not that large.
    #[error("{name}: does not open to f/{f_number}; its stop wide open is f/{widest:.2}")]
    TooWide {
        /// The lens.
        name: String,
        /// What was asked for.
        f_number: f64,
        /// What it has.
        widest: f64,
    },
    /// The table was read and is no lens that light goes through.
    #[error("{name}: {what}")]
    Unfit {
        /// The lens.
        name: String,
        /// What is wrong.
        what: String,
    },
}
