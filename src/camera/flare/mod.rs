//! Lens flare: the sun's two-reflection ghosts on the sensor.
//!
//! ```text
//! lens, angle ─▶ mesh (paraxial quads | exact grids | blended) ─┐
//! aperture ─▶ mask ──────────────────────────────────────────────┴▶ pass ─┬▶ radiance added to the picture
//!         └─▶ starburst (FFT) ─▶ star pass ───────────────────────────────┘
//! ```
//! Brightness is in proportion to the sun's: see `mesh`.
//!
//! What the two patents ask for, where it is, and the test that holds it:
//!
//! | method | function | test |
//! |---|---|---|
//! | KR 10-1465658: a matrix each for translation, refraction, reflection | `paraxial::{translation, refraction, reflection}` and their backward forms | `matrices_are_the_derivative_of_the_exact_trace`, `the_literal_inverse_is_the_wrong_sign` |
//! | their product along the order of surfaces that the light meets, reflections included | `path::path`, `Paraxial::matrices` | `every_ray_of_the_independent_trace_of_the_heliar` |
//! | split at the stop, Mf = Ms Ma | `PathMatrices` | the same |
//! | all pairs of reflections; those that cross the stop once are drawn | `path::{ghosts, single_crossing_ghosts}` | `ghosts_that_cross_the_stop_once` |
//! | a quad of four entrance points carried to the sensor | `mesh::quad` | `each_mode_comes_near_dense_exact_rays` |
//! | the aperture as a texture, looked up through Ma | `Aperture::mask`, `shaders/camera/flare.wgsl` | `a_ghost_keeps_its_light` |
//! | entrance cut to the lens barrel and the effective pupil | `LinearGhost::new` | `the_effective_pupil_changes_nothing_but_the_work` |
//! | brightness by the ratio of entrance to sensor area, coatings, colours | `source::radiance`, `lens::reflectance`, `spectrum` | `a_ghost_keeps_its_light`, `reflectance_obeys_the_closed_forms`, `a_spectrum_adds_up_to_white` |
//! | KR 10-1658883: which ghosts depart from linear | `nonlinearity` | `each_mode_comes_near_dense_exact_rays` |
//! | nonlinear ghosts recorded beforehand over the angle of the light, and turned at play-back | `FlareTable`, `TabledGhost::grid`, `source::turned` | `the_table_comes_near_dense_exact_rays` |
//! | linear and recorded ghosts blended, by addition | `flare_mesh`, `FlarePass` | the same |
//!
//! Not there yet: the variant with two rays a ghost, blending by interpolation and by alpha, a table over two angles for lenses
//! without symmetry, and a table made from photos.

mod added;
mod aperture;
mod blend;
mod grid;
mod linear;
mod mesh;
mod nonlinear;
mod pass;
mod quad;
mod quality;
mod source;
mod spectrum;
mod sprite;
mod star_pass;
mod starburst;
mod table;
mod tracing;

pub use aperture::Aperture;
pub use blend::{Blend, Fit};
pub use mesh::{FlareMesh, FlareMode, FlareRecipe, Pattern, flare_mesh};
pub use nonlinear::nonlinearity;
pub use pass::FlarePass;
pub use quality::{Preset, Quality};
pub use source::{FlareSource, FlareVertex};
pub use spectrum::{Wavelength, spectrum};
pub use sprite::{Sprite, SpriteFrame, encode_images, encode_sprite};
pub use star_pass::{Star, encode_starburst};
pub use starburst::{Diffraction, fft_2d};
pub use table::{
    FlareTable, ImageTable, LightImage, TableError, TableFile, open_table, table_from_photos, write_table,
};
pub use tracing::Tracing;

use added::{Laid, added_pipeline, picture_group};
