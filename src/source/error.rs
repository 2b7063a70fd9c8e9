//! Why a source file could not be used: the file, what is wrong, and what to do where that lies with the file. What a
//! command can be told instead is the command line's to say (`cli::advice`).

use std::path::PathBuf;

use thiserror::Error;

use super::listed;
use crate::space::CrsError;

/// What a source file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceRole {
    /// Ground heights.
    Terrain,
    /// Building footprints.
    Footprints,
    /// Orthophotos.
    Imagery,
    /// Roads, rails, water, green.
    Plan,
    /// A flight.
    Track,
}

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
    /// Its features cannot be told by their ids.
    #[error("{}: keeps no ids of its features and has no column fid that says which buildings they are; add one, or use a GeoPackage", path.display())]
    NoIds {
        /// The file.
        path: PathBuf,
    },
    /// It holds no track.
    #[error("{}: holds no track or route; give a file with one, or a list of views", path.display())]
    NoTrack {
        /// The file.
        path: PathBuf,
    },
    /// It says nothing of its CRS.
    #[error("{}: has no coordinate reference system", path.display())]
    NoCrs {
        /// The file.
        path: PathBuf,
        /// What it was given as.
        role: SourceRole,
    },
    /// Its coordinates cannot be what its CRS says.
    #[error("{}: {why}", path.display())]
    WrongCrs {
        /// The file.
        path: PathBuf,
        /// What it was given as.
        role: SourceRole,
        /// What failed.
        why: String,
    },
    /// Orthophotos given as terrain.
    #[error("{}: looks like an orthophoto (three or more 8-bit bands), not like terrain", path.display())]
    NotTerrain {
        /// The file.
        path: PathBuf,
    },
    /// More than one layer may hold the footprints.
    #[error("{}: has several layers ({})", path.display(), listed(layers))]
    SeveralLayers {
        /// The file.
        path: PathBuf,
        /// Their names.
        layers: Vec<String>,
    },
    /// No layer of the name, or none with areas.
    #[error("{}: {}; its layers are {}", path.display(), match wanted {
        Some(name) => format!("has no layer '{name}'"),
        None => "has no layer of areas (building footprints are polygons)".to_owned(),
    }, listed(layers))]
    NoLayer {
        /// The file.
        path: PathBuf,
        /// The name asked for.
        wanted: Option<String>,
        /// The names there are.
        layers: Vec<String>,
    },
    /// No field of the name.
    #[error("{}: has no field '{field}'; {}", path.display(), match fields.as_slice() {
        [] => "it has no fields at all: a shapefile needs its .dbf beside it".to_owned(),
        fields => format!("its fields are {}", listed(fields)),
    })]
    NoField {
        /// The file.
        path: PathBuf,
        /// The name asked for.
        field: String,
        /// The names there are.
        fields: Vec<String>,
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
            plainly(msg)
        }
        other => other.to_string(),
    }
}

/// GDAL's last message on this thread when it was a failure: OGR ends a damaged file like a finished one.
pub fn gdal_failure() -> Option<String> {
    // SAFETY: the message is GDAL's thread-local buffer, copied at once.
    unsafe {
        let failed = gdal_sys::CPLGetLastErrorType() >= gdal_sys::CPLErr::CE_Failure;
        let message = std::ffi::CStr::from_ptr(gdal_sys::CPLGetLastErrorMsg());
        failed.then(|| plainly(&message.to_string_lossy()))
    }
}

/// Forgets GDAL's last message on this thread, so that the next one is of what is done next.
pub fn reset_gdal_error() {
    // SAFETY: no arguments, thread-local state.
    unsafe { gdal_sys::CPLErrorReset() };
}

/// The end of a message that begins with a whole statement.
fn plainly(msg: &str) -> String {
    // SQLite's refusals stand behind the whole statement.
    let said = match msg.starts_with("sqlite3_exec(") {
        true => msg.rsplit(") failed: ").next().unwrap_or(msg),
        false => msg,
    };
    match said.trim_end_matches('.') {
        said if said.ends_with("disk is full") => "no space left on the disk".to_owned(),
        said => said.to_owned(),
    }
}
