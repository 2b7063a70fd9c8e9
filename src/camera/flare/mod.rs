//! Lens flare: the sun's two-reflection ghosts on the sensor.
//!
//! ```text
//! lens, light ─▶ ghost (linear, nonlinear) ◀─ table (of rays | of images) ─┐
//! aperture ─▶ starburst (FFT) ─────────────────────────────────────────────┼▶ draw: one pass adds them to the radiance
//!         └─▶ mask ────────────────────────────────────────────────────────┘
//! ```
//! Brightness is in proportion to the sun's: see `ghost`. What it may cost: `quality`.
//!
//! What the two patents ask for, where it is, and the test that holds it. A = KR 10-1465658 (22 claims, of which 4, 8, 14 and 18 were
//! deleted; 13 to 22 are the apparatus of 1 to 12), B = KR 10-1658883 (20 claims; 12 to 20 are the apparatus of 1 to 11); rows without a
//! number are methods of their descriptions and of Lee & Eisemann 2013.
//!
//! | claim | what | function | test |
//! |---|---|---|---|
//! | A 1, 13 | from radii or refractive indices the change of a light's path at each lens, from it positions on the sensor | `Paraxial::new`, `LinearGhost::sensor` | `matrices_are_the_derivative_of_the_exact_trace`, `focal_lengths` |
//! | A 2 | the changes as matrices | `paraxial::{translation, refraction, reflection}` | `the_literal_inverse_is_the_wrong_sign` |
//! | A 3 | to first order about the axis | `Paraxial::matrices` | `matrices_are_the_derivative_of_the_exact_trace` |
//! | A 5, 15 | their product in the order in which the light meets the surfaces | `path::path` | `every_ray_of_the_committed_independent_trace` |
//! | A 6, 16 | reflections among them | `path::ghosts`, `reflection_backward` | `ghosts_that_cross_the_stop_once` |
//! | A 7, 17 | the size of a sprite from positions on the sensor | `quad::quad` | `each_mode_comes_near_dense_exact_rays` |
//! | A 9, 19 | from the ray through the centre of the area where light comes in and the farthest one | `quad::two_rays` | `the_centre_and_the_farthest_ray_place_a_ghost`, `two_rays_draw_what_four_do` |
//! | A 10, 20 | brightness by the ratio of entrance to sensor area | `FlareSource::radiance` | `a_ghost_keeps_its_light` |
//! | A 11, 21 | entrance cut to the lens barrel and the effective pupil | `LinearGhost::new` | `the_effective_pupil_changes_nothing_but_the_work` |
//! | A 12, 22 | a flare in the shape of the iris | `Aperture::mask`, `shaders/camera/ghost.wgsl` | `a_ghost_has_the_shape_of_the_iris` |
//! | | split at the stop, Mf = Ms Ma | `PathMatrices` | `every_ray_of_the_independent_trace_of_the_heliar` |
//! | | coatings, colours | `lens::reflectance`, `spectrum` | `reflectance_agrees_with_an_independent_transfer_matrix`, `a_spectrum_adds_up_to_white` |
//! | B 1, 12 | nonlinear patterns, found and made beforehand by the light's position, and blended with linear ones | `nonlinearity`, `FlareTable::bake`, `flare_mesh` | `the_table_comes_near_dense_exact_rays`, `tables_hold_for_other_lenses` |
//! | B 2, 13, 15 | ghosts found, the angle varied, kept in a look-up table | `single_crossing_ghosts`, `TabledGhost` | `tables_hold_for_other_lenses` |
//! | B 3, 16 | patterns out of photos and of a video of the light's passage | `table_from_photos`, `video_frames` | `one_table_holds_traced_and_photographed_patterns` |
//! | B 4, 17 | when it is drawn, the linear part with the traced patterns or the photographed ones | `GhostTable::at`, `GhostParameters::photographed` | `one_table_holds_traced_and_photographed_patterns` |
//! | B 5, 18 | picked by the angle, rotated about the axis with the light, and blended with the linear part | `FlareSource::rotated`, `EvaluatedImage::rotation`, `Blend` | `patterns_turn_with_the_light` |
//! | B 6 | size and brightness fitted to the linear ghosts | `blend::fitted` | `nonlinear_ghosts_can_be_fitted_to_linear_ones` |
//! | B 7 | blended by addition | `blend::fractions`, `Blend` | `each_mode_comes_near_dense_exact_rays` |
//! | B 8, 9 | by interpolation, by alpha | `blend::fractions`, `FlareEffect` | `blends_pass_from_linear_to_nonlinear`, `fractions_pass_from_linear_to_nonlinear` |
//! | B 10, 19 | photographed patterns alone, without linear ones | `GhostTable::at`, `ImageTable::with_linear` | `photographed_patterns_are_drawn_alone` |
//! | B 11 | a table over two angles, compressed, in its file | `bake_images`, `write_table` | `patterns_turn_with_the_light` |
//! | B 14, 20 | traced patterns, by one angle or two, and photographed ones in one packed table | `GhostTable::with_photos`, `write_table` | `one_table_holds_traced_and_photographed_patterns` |
//! | | the light's disc | `Softness`, `SoftPlan` | `the_suns_ghosts_are_the_mean_of_its_points`, `softening_keeps_a_ghosts_light` |

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
    FlareTable, GhostTable, ImageKnots, ImageTable, LightImage, PlayedPatterns, TableError, TracedPatterns,
    bake_images, open_table, table_from_photos, write_table,
};
