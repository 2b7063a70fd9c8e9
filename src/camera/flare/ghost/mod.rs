//! Ghosts: light that two surfaces reflect, as triangles on the sensor.
//!
//! ```text
//! lens, light ─▶ mesh: which image of which ghost (nonlinearity, blend)
//!                 ├▶ linear ─▶ quad ────────────────────────┐
//!                 └▶ tracing (CPU | GPU) or table ─▶ grid ──┴▶ vertices ─▶ layers (by how they are softened)
//! ```

mod area;
mod blend;
mod coverage;
mod ghost_triangles;
pub(super) mod grid;
mod layers;
pub(super) mod linear;
mod mesh;
mod nonlinear_images;
pub(super) mod nonlinearity;
mod parameters;
mod patches;
mod quad;
mod softness;
pub(super) mod tracing;
mod vertex;

pub use area::area_on_film;
pub use blend::{Blend, Fit};
pub use coverage::Coverage;
pub use ghost_triangles::GhostTriangles;
pub use linear::MAX_SOFTNESS;
pub use mesh::{FlareMesh, flare_mesh};
pub use nonlinearity::nonlinearity;
pub use parameters::{FlareMode, FlareParameters, GhostParameters, Pattern};
pub use tracing::{Tracing, TracingDevice};
pub use vertex::{FlareSource, FlareVertex};
