//! Drawing: what of a flare lives on the device, and the passes that add it to an image.
//!
//! ```text
//! request ─▶ prepare ┬▶ aperture's mask ─┐
//!                    ├▶ ghosts' mesh ────┴▶ ghost layer ──┤ (soft plan ─▶ soft levels: ghosts of a disc)
//!                    ├▶ a table's images ─▶ sprites ──────┼▶ encode
//!                    └▶ starburst ────────▶ sprite ───────┘
//! ```

mod effect;
mod ghost_frame;
mod ghost_layer;
mod guard_band;
mod imager;
mod request;
mod resources;
mod soft_levels;
mod soft_masks;
mod soft_plan;
mod sprite_layer;
mod touched_blocks;

pub use effect::{CacheFills, FlareEffect, MeshStatistics};
pub use ghost_frame::{FlareFrame, GhostRecord};
pub use imager::{FlareImage, FlareImager, film_half_mm};
pub use request::{FlareLight, FlareRequest};
pub use resources::{FLARE_INPUT, GHOST_INPUT, IMAGE_INPUT};
pub use soft_levels::SOFT_MARGIN;
pub use soft_masks::{MASK_EXTENT, MIN_SOFTNESS, SOFT_EXTENT, SOFT_MASKS};
pub use sprite_layer::SpriteFrame;
