//! Lens flare: the sun's two-reflection ghosts on the sensor.
//!
//! ```text
//! lens, light ─▶ ghost (linear, nonlinear) ◀─ table (of rays | of images) ─┐
//! aperture ─▶ starburst (FFT) ─────────────────────────────────────────────┼▶ draw: one pass adds them to the radiance
//!         └─▶ mask ────────────────────────────────────────────────────────┘
//! ```
//! Brightness is in proportion to the sun's: see `ghost`. What it may cost: `quality`.
//!
//! What the two patents ask for, where it is, and the test that holds it. Numbers of claims are those of the United States
//! members of the family: A = US 9,595,132 (of KR 10-1465658), B = US 10,074,195 (of KR 10-1658883); rows without a number are
//! methods of their descriptions and of Lee & Eisemann 2013.
//!
//! | claim | what | function | test |
//! |---|---|---|---|
//! | A 1 | changes of a light's path at lenses to first order, as a product of matrices; from them positions on the sensor | `paraxial::{translation, refraction, reflection}`, `Paraxial::matrices`, `LinearGhost::sensor` | `matrices_are_the_derivative_of_the_exact_trace`, `the_literal_inverse_is_the_wrong_sign` |
//! | A 2 | from radii and refractive indices | `Paraxial::new` | `focal_lengths` |
//! | A 3 | in the order in which the light meets the surfaces | `path::path` | `every_ray_of_the_committed_independent_trace` |
//! | A 4 | reflections among them | `path::ghosts` | `ghosts_that_cross_the_stop_once` |
//! | | split at the stop, Mf = Ms Ma | `PathMatrices` | `every_ray_of_the_independent_trace_of_the_heliar` |
//! | | four entrance points carried to the sensor as a quad | `quad::quad` | `each_mode_comes_near_dense_exact_rays` |
//! | | the same from two rays | `quad::two_rays` | `two_rays_draw_what_four_do` |
//! | | the aperture as a texture, looked up through Ma | `Aperture::mask`, `shaders/camera/ghost.wgsl` | `a_ghost_keeps_its_light` |
//! | | entrance cut to the lens barrel and the effective pupil | `LinearGhost::new` | `the_effective_pupil_changes_nothing_but_the_work` |
//! | | brightness by the ratio of entrance to sensor area, coatings, colours | `FlareSource::radiance`, `lens::reflectance`, `spectrum` | `a_ghost_keeps_its_light`, `reflectance_agrees_with_an_independent_transfer_matrix`, `a_spectrum_adds_up_to_white` |
//! | B 1 | nonlinear patterns of ghosts, found, made beforehand over the angle from the axis, kept in a table, and drawn with linear ones | `nonlinearity`, `FlareTable::bake`, `flare_mesh` | `the_table_comes_near_dense_exact_rays` |
//! | B 2 | patterns out of images taken at known angles | `table_from_photos`, `ImageTable` | `tables_of_images_give_what_was_recorded` |
//! | B 3 | at evaluation, the linear part or not, as the table says | `ImageTable::with_linear`, `TableFile::at` | the same |
//! | B 4 | rotated about the axis with the light, and blended with the linear part | `FlareSource::rotated`, `EvaluatedImage::rotation`, `Blend` | the same, `blends_pass_from_linear_to_nonlinear` |
//! | | blends by addition, interpolation and alpha | `blend::fractions`, `FlareEffect` | `blends_pass_from_linear_to_nonlinear` |
//! | | size and brightness fitted to the linear ghosts | `blend::fitted` | `nonlinear_ghosts_can_be_fitted_to_linear_ones` |
//! | | a table over two angles, compressed | `bake_images`, `write_table` | `tables_of_images_give_what_was_recorded` |

mod aperture;
mod draw;
mod ghost;
mod quality;
mod spectrum;
mod starburst;
mod table;

pub use aperture::Aperture;
pub use draw::{
    CacheFills, FLARE_INPUT, FlareEffect, FlareFrame, FlareImage, FlareImager, FlareLight, FlareRequest,
    GHOST_INPUT, GhostRecord, IMAGE_INPUT, MASK_EXTENT, MIN_SOFTNESS, MeshStatistics, SOFT_EXTENT,
    SOFT_MARGIN, SOFT_MASKS, SpriteFrame, film_half_mm,
};
pub use ghost::{
    Blend, Fit, FlareMesh, FlareMode, FlareParameters, FlareSource, FlareVertex, GhostParameters,
    GhostTriangles, MAX_SOFTNESS, Pattern, Tracing, TracingDevice, area_on_film, flare_mesh, nonlinearity,
};
pub use quality::{Preset, Quality};
pub use spectrum::{Wavelength, spectrum};
pub use starburst::{Diffraction, StarburstOptics, StarburstParameters, StarburstPattern, fft_2d};
pub use table::{
    FlareTable, ImageKnots, ImageTable, LightImage, TableError, TableFile, bake_images, open_table,
    table_from_photos, write_table,
};
