//! The city folder: one folder is one city, every file a standard format.

mod building_details;
mod city_files;
mod codec;
mod durable;
mod edit;
mod error;
mod geotiff;
mod ground_cache;
mod imagery_tile;
mod layer;
mod import;
mod import_lock;
mod manifest;
mod raised_footprints;
mod rules_file;
mod staging;
mod store;
mod tile;
mod update;
mod writer;

pub use building_details::BuildingDetails;
pub use city_files::enclosing_city;
pub use codec::TerrainTile;
pub use edit::{Edit, EditReport, Editor};
pub use error::CityError;
pub use imagery_tile::ImageryTile;
pub use import::{
    ImportOptions, ImportProgress, ImportReport, ImportStage, ImportWarning, PlanFiles, Setting, import,
};
pub use layer::Layer;
pub use manifest::{Manifest, OperationRecord, SourceRecord};
pub use raised_footprints::{RaisedFootprints, building_map, buildings_by_tile, raise_footprints};
pub use store::City;
pub use tile::{Tile, ground_at};
pub use update::{UpdateOptions, UpdateReport, update};
