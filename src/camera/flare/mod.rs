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
mod grid;
mod linear;
mod mesh;
mod nonlinear;
mod pass;
mod source;
mod spectrum;
mod star_pass;
mod starburst;
mod table;

pub use aperture::Aperture;
pub use mesh::{FlareMode, flare_mesh};
pub use nonlinear::nonlinearity;
pub use pass::FlarePass;
pub use source::{FlareSource, FlareVertex};
pub use spectrum::{Wavelength, spectrum};
pub use star_pass::{Star, encode_starburst};
pub use starburst::{Diffraction, fft_2d};
pub use table::FlareTable;

use added::{added_pipeline, picture_group};
