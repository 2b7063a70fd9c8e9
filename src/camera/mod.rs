//! The optics between radiance and the image: the lens, its paths of light, and the display.
//!
//! ```text
//! lens ─▶ path ─▶ paraxial ─┐
//!               └▶ trace ───┴▶ diagram, flare
//!                   └▶ rays (its twin on the GPU, many at once)
//! radiance ─▶ flare ─▶ develop ─▶ image
//! ```

mod develop;
mod diagram;
mod exposure;
pub mod flare;
pub mod lens;
mod paraxial;
mod path;
mod rays;
mod shaders;
mod tone_curve;
mod trace;

pub use develop::Develop;
pub use diagram::lens_diagram;
pub use exposure::auto_exposure;
pub use paraxial::{
    Paraxial, PathMatrices, reflection, reflection_backward, refraction, refraction_backward, translation,
};
pub use path::{Ghost, Step, crossings, ghosts, path, single_crossing_ghosts};
pub use rays::{Bundle, BundleRecord, InterfaceRecord, RayPass, RayRecord};
pub use shaders::ALL as SHADERS;
pub use tone_curve::{shoulder, srgb, tone_curve, tone_mapped};
pub use trace::{TracedRay, Tracer, beam_direction};
