//! The starburst: the light's image spread by the aperture's diffraction.
//!
//! ```text
//! aperture ─▶ diffraction (FFT) ─▶ pattern (disc, colours) ─▶ draw
//! ```

mod diffraction;
mod pattern;

pub use diffraction::{Diffraction, fft_2d};
pub use pattern::{StarburstOptics, StarburstParameters, StarburstPattern};
