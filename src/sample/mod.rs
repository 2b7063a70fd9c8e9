//! The sample city's source files: a made-up hill town by a river, in real formats, the same at every run.
//!
//! ```text
//! landscape ─▶ blocks ─▶ buildings, trees ─▶ photo
//!     └──────────────────────┴──────────────────┴─▶ files: DTM, GeoPackage, photo tiles
//! ```

mod blocks;
mod buildings;
mod features;
mod files;
mod landscape;
mod noise;
mod photo;
mod shapes;
mod town;

pub use features::{SampleBuilding, Tree};
pub use files::{SampleFiles, write_sample};
pub use town::Town;
