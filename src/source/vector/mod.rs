//! Footprints: any vector format OGR reads, and CityJSON.

mod cityjson;
mod clean;
mod footprint_dataset;
mod feature;
mod footprint_source;
mod heights;
mod known_fields;
mod outline;
mod read_footprints;
mod report;

pub use clean::{CleanReport, clean_outline};
pub use footprint_dataset::{FootprintDataset, FootprintDatasetWriter};
pub use footprint_source::FootprintSource;
pub use outline::Outline;
pub use report::{FieldCount, FootprintReport};
