//! Footprints: any vector format OGR reads, and CityJSON.

mod cityjson;
mod cityjson_text;
mod clean;
mod file_end;
mod dataset_editor;
mod footprint_dataset;
mod feature;
mod footprint_lookup;
mod footprint_source;
mod heights;
mod known_fields;
mod outline;
mod own_triggers;
mod plain_geopackage;
mod plan_features;
mod read_footprints;
mod report;
mod track;
mod traits;

pub use clean::{CleanReport, clean_outline};
pub use dataset_editor::FootprintDatasetEditor;
pub use footprint_dataset::{FootprintDataset, FootprintDatasetWriter};
pub use footprint_lookup::FootprintChange;
pub use footprint_source::FootprintSource;
pub use outline::Outline;
pub use plain_geopackage::roll_back;
pub use plan_features::{PlanFeature, PlanKind, read_plan};
pub use read_footprints::Selection;
pub use report::{FieldCount, FootprintReport};
pub use track::{TrackPoint, read_track};
