//! Ghosts recorded beforehand: the look-up table of strongly nonlinear ghosts (KR 10-1658883).
//!
//! ```text
//! lens ─▶ bake (grids of rays by angle) ─▶ FlareTable ────────────┐
//! photos and videos, or whole flares by two angles ─▶ ImageTable ─┴▶ GhostTable (traced, photographed) ─▶ file ─▶ evaluation
//! ```

mod bake;
mod file;
mod ghost_table;
mod image_bake;
mod images;
mod photos;
mod ray_table;
mod knot;
mod nearness;
mod video_frames;

pub use file::{TableError, open_table, write_table};
pub use ghost_table::{GhostTable, PlayedPatterns, TracedPatterns};
pub use image_bake::{ImageKnots, bake_images};
pub use images::{ImageTable, LightImage};
pub use photos::table_from_photos;
pub use ray_table::FlareTable;
