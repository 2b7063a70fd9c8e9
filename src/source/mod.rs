//! What the survey office gives: georeferenced grids, footprints and orthophotos, read by GDAL and OGR.
//!
//! Everything leaves here in metres and in the city's CRS.

mod crs_choice;
mod error;
mod footprint;
mod raster;
mod spatial_reference;
mod vector;

pub use crs_choice::CrsChoice;
pub use error::SourceError;
use error::gdal_says;
pub use footprint::{Footprint, HeightRule, RoofSpec};
pub use raster::{Dtm, DtmSampler, Imagery};
pub use spatial_reference::{gdal_reference, silence_gdal};
pub use vector::{
    CleanReport, FootprintDataset, FootprintDatasetWriter, FootprintReport, FootprintSource, Outline,
    clean_outline,
};
