//! What the survey office gives: georeferenced grids, footprints and orthophotos, read by GDAL and OGR.
//!
//! Everything leaves here in metres and in the city's CRS.

mod archive;
mod crs_choice;
mod error;
mod files;
mod footprint;
mod ground_rules;
mod height_rule;
mod height_text;
mod identify;
mod listed;
mod raster;
mod sound_file;
mod spatial_reference;
mod vector;

pub use crs_choice::CrsChoice;
pub use error::{SourceError, SourceRole, gdal_says};
use error::{gdal_failure, reset_gdal_error};
pub use files::files_of;
pub use footprint::{BuildingTraits, Footprint, HeightOrigin, RoofSpec};
pub use ground_rules::GroundRules;
pub use height_rule::{HeightField, HeightReading, HeightRule};
pub use identify::{SurveyFile, SurveyKind, identify};
pub use listed::listed;
pub use raster::{Dtm, DtmSampler, ImageryMosaic, SampleLattice, SteppedHeights};
pub use sound_file::{open_regular, require_sound};
pub use spatial_reference::{OFFLINE, gdal_reference, silence_gdal};
pub use vector::{
    CleanReport, FieldCount, FootprintChange, FootprintDataset, FootprintDatasetEditor,
    FootprintDatasetWriter, FootprintReport, FootprintSource, Outline, PlanFeature, PlanKind, Selection,
    TrackPoint, clean_outline, read_plan, read_track, roll_back,
};
