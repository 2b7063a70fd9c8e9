//! Lens flare: the sun's two-reflection ghosts on the sensor.
//!
//! ```text
//! lens, angle ─▶ mesh (paraxial quads | exact grids | blended) ─┐
//! aperture ─▶ mask ──────────────────────────────────────────────┴▶ pass ─┬▶ radiance added to the picture
//!         └─▶ starburst (FFT) ─▶ star pass ───────────────────────────────┘
//! ```
//! Brightness is in proportion to the sun's: see `mesh`.

mod added;
mod aperture;
mod mesh;
mod pass;
mod spectrum;
mod star_pass;
mod starburst;

pub use aperture::Aperture;
pub use mesh::{FlareMode, FlareSource, FlareVertex, flare_mesh, nonlinearity};
pub use pass::FlarePass;
pub use spectrum::{Wavelength, spectrum};
pub use star_pass::{Star, encode_starburst};
pub use starburst::{Diffraction, fft_2d};

use added::{added_pipeline, picture_group};
