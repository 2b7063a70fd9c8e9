//! Drawing: what of a flare lives on the device, and the one render pass that adds it to an image.
//!
//! ```text
//! request ─▶ prepare ┬▶ aperture's mask ─┐
//!                    ├▶ ghosts' mesh ────┴▶ ghost layer ──┐
//!                    ├▶ a table's images ─▶ sprites ──────┼▶ encode
//!                    └▶ starburst ────────▶ sprite ───────┘
//! ```

mod effect;
mod ghost_layer;
mod imager;
mod request;
mod resources;
mod sprite_layer;

pub use effect::{CacheFills, FlareEffect, MeshStatistics};
pub use ghost_layer::FlareFrame;
pub use imager::{FlareImage, FlareImager, film_half_mm};
pub use request::{FlareLight, FlareRequest};
pub use resources::FLARE_INPUT;
pub use sprite_layer::SpriteFrame;
