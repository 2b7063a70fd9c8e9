//! The sample city's source files: a made-up hill town by a river, in real formats, the same at every run.
//!
//! ```text
//! landscape ─▶ blocks ─▶ buildings, trees ─▶ orthophoto
//!     └──────────────────────┴──────────────────┴─▶ files: DTM, GeoPackage, orthophoto tiles
//! ```

mod blocks;
mod buildings;
mod features;
mod source_files;
mod landscape;
mod noise;
mod orthophoto;
mod region;
mod shapes;
mod town;

pub use features::{SampleBuilding, Tree};
pub use source_files::{SampleFiles, write_region, write_sample};
pub use town::Town;
