//! Why a source file could not be used: the file, what is wrong, what to do.

use std::path::PathBuf;

use thiserror::Error;

use crate::space::CrsError;

/// A source file was refused.
#[derive(Debug, Error)]
pub enum SourceError {
    /// GDAL cannot open it.
    #[error("{}: cannot be opened ({why}); check the path and that it is a {expected} GDAL reads (gdalinfo or ogrinfo should list it)", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What GDAL said.
        why: String,
        /// "raster" or "vector file".
        expected: &'static str,
    },
    /// It opened, but its data cannot be read.
    #[error("{}: is damaged or truncated ({why}); get the file again", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What GDAL said.
        why: String,
    },
    /// It says nothing of its CRS.
    #[error("{}: has no coordinate reference system; name it with {flag} EPSG:n", path.display())]
    NoCrs {
        /// The file.
        path: PathBuf,
        /// The command-line flag that mends it.
        flag: &'static str,
    },
    /// Its CRS cannot be used or transformed.
    #[error("{}: {source}", path.display())]
    Crs {
        /// The file.
        path: PathBuf,
        /// Why.
        source: CrsError,
    },
    /// It is not what it was given as.
    #[error("{}: {what}; {advice}", path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
        /// What to do.
        advice: String,
    },
    /// It could not be written.
    #[error("{}: cannot be written ({why})", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What GDAL said.
        why: String,
    },
}

/// What GDAL itself says of an error, without the binding's words around it.
pub fn gdal_says(error: &gdal::errors::GdalError) -> String {
    use gdal::errors::GdalError;
    match error {
        GdalError::NullPointer { msg, .. } | GdalError::CplError { msg, .. } if !msg.is_empty() => {
            msg.trim_end_matches('.').to_owned()
        }
        other => other.to_string(),
    }
}
