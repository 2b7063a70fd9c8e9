//! Why a coordinate reference system could not be used.

use thiserror::Error;

/// A CRS was refused, or two have nothing between them.
#[derive(Debug, Error)]
pub enum CrsError {
    /// The text names no CRS that PROJ knows.
    #[error("'{text}' is not a coordinate reference system ({why}); give one like EPSG:25832")]
    Unknown {
        /// What was given.
        text: String,
        /// What PROJ said.
        why: String,
    },
    /// The city's CRS must be projected, in metres, east and north.
    #[error(
        "{crs} cannot be a city's CRS: it must be projected, in metres, with axes east and north; give one like EPSG:25832 or the UTM zone of the place"
    )]
    NotMetric {
        /// The CRS's label.
        crs: String,
    },
    /// PROJ finds no operation from one to the other.
    #[error("no transformation from {from} to {to}: {why}")]
    NoTransformation {
        /// Source label.
        from: String,
        /// Target label.
        to: String,
        /// What PROJ said.
        why: String,
    },
}
