//! Footprints: any vector format OGR reads, and CityJSON.

mod cityjson;
mod clean;
mod digital_map;
mod feature;
mod footprints;
mod report;

pub use clean::{CleanReport, Outline, clean_outline};
pub use digital_map::{DigitalMap, MapWriter};
pub use footprints::FootprintSource;
pub use report::FootprintReport;
