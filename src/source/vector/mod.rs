//! Footprints: any vector format OGR reads, and CityJSON.

mod cityjson;
mod clean;
mod footprint_dataset;
mod feature;
mod footprints;
mod heights;
mod known_fields;
mod outline;
mod reading;
mod report;

pub use clean::{CleanReport, clean_outline};
pub use footprint_dataset::{FootprintDataset, FootprintDatasetWriter};
pub use footprints::FootprintSource;
pub use outline::Outline;
pub use report::{FieldCount, FootprintReport};
