//! The starburst: the light's image spread by the aperture's diffraction.
//!
//! ```text
//! aperture ─┬▶ diffraction (FFT) ─▶ pattern (disc, colours) ─▶ draw
//!           └▶ glare (spikes beyond the transform, veil) ──────▶ draw
//! ```

mod diffraction;
mod glare;
mod pattern;

pub use diffraction::{Diffraction, fft_2d};
pub use pattern::{StarburstOptics, StarburstParameters, StarburstPattern};
