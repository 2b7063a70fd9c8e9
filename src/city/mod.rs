//! The city folder: one folder is one city, every file a standard format (DESIGN: the city folder).

mod codec;
mod error;
mod geotiff;
mod ground;
mod import;
mod manifest;
mod staging;
mod store;

pub use codec::{ImageryTile, TerrainTile};
pub use error::CityError;
pub use import::{ImportOptions, ImportReport, import};
pub use manifest::{Manifest, OperationRecord, SourceRecord};
pub use store::City;
