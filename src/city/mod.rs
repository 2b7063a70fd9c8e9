//! The city folder: one folder is one city, every file a standard format (DESIGN: the city folder).

mod codec;
mod error;
mod geotiff;
mod ground;
mod import;
mod manifest;
mod raised;
mod staging;
mod store;
mod tile;
mod writer;

pub use codec::{ImageryTile, TerrainTile};
pub use error::CityError;
pub use import::{ImportOptions, ImportReport, ImportWarning, Setting, import};
pub use manifest::{Manifest, OperationRecord, SourceRecord};
pub use raised::{RaisedFootprints, building_map, buildings_by_tile, raise_footprints};
pub use store::City;
pub use tile::{Tile, ground_at};
