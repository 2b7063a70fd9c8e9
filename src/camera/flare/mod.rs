//! Lens flare: the sun's two-reflection ghosts on the sensor.
//!
//! ```text
//! lens, angle ─▶ mesh (paraxial quads | exact grids | blended) ─┐
//! aperture ─▶ mask ──────────────────────────────────────────────┴▶ pass ─▶ radiance added to the picture
//! ```
//! Brightness is in proportion to the sun's: see `mesh`.

mod aperture;
mod mesh;
mod pass;
mod spectrum;

pub use aperture::Aperture;
pub use mesh::{FlareMode, FlareSource, FlareVertex, flare_mesh, nonlinearity};
pub use pass::FlarePass;
pub use spectrum::{Wavelength, spectrum};
