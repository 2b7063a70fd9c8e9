//! The optics between radiance and the image: the camera, its lens, the paths of light through it, what it adds, and tone mapping.
//!
//! ```text
//! lens ─▶ path ─▶ paraxial ─┬▶ optics (Camera: projection, sun on the sensor; vignetting)
//!               └▶ trace ───┴▶ diagram, flare
//!                   └▶ rays (its twin on the GPU, many at once)
//! radiance ─▶ accumulate | temporal (in motion) ─┐
//!                                        flare ─┴▶ tone_map ─▶ image
//! ```

mod accumulate_pass;
mod diagram;
mod auto_exposure;
mod daylight_exposure;
pub mod flare;
pub mod lens;
mod paraxial;
mod optics;
mod path;
mod ray_bundles;
mod shaders;
mod temporal_pass;
mod tone_map_pass;
mod tone_curve;
mod trace;
mod vignetting;

pub use accumulate_pass::AccumulatePass;
pub use auto_exposure::auto_exposure;
pub use daylight_exposure::{daylight, daylight_exposure, towards_sun_exposure, white_balance};
pub use diagram::lens_diagram;
pub use optics::{Camera, FULL_FRAME_MM, LensOptics, Optics, require_f_number};
pub use paraxial::{
    Paraxial, PathMatrices, reflection, reflection_backward, refraction, refraction_backward, translation,
};
pub use path::{Ghost, Step, crossings, ghosts, path, single_crossing_ghosts};
pub use ray_bundles::{Bundle, BundleRecord, InterfaceRecord, RayPass, RayRecord};
pub use shaders::ALL as SHADERS;
pub use temporal_pass::{Motion, TemporalPass};
pub use tone_curve::{START_COMPRESSION, shoulder, srgb, tone_curve, tone_mapped};
pub use tone_map_pass::{Exposure, ToneMapPass, ToneMapping};
pub use trace::{TracedRay, Tracer, beam_direction};
pub use vignetting::{FALLOFF_PLACES, Vignetting};
