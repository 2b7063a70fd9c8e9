//! Footprints: any vector format OGR reads, and CityJSON.

mod cityjson;
mod clean;
mod digital_map;
mod feature;
mod footprints;
mod outline;
mod reading;
mod report;

pub use clean::{CleanReport, clean_outline};
pub use digital_map::{DigitalMap, MapWriter};
pub use footprints::FootprintSource;
pub use outline::Outline;
pub use report::FootprintReport;
