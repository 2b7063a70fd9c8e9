//! Image-based extrusion displacement mapping of any textured rectangle: the method of KR 10-0738500 (Yoo & Han, "Method for
//! image-based extrusion displacement mapping, and method for dual displacement mapping using the same") by itself.
//!
//! Where each of its claims is, and what tests it. `extrusion.wgsl` and `search.wgsl` are in `shaders/relief`, `extrusion_search.wgsl` in
//! `shaders/lib`. Tests without a file are in `tests/extrusion.rs`.
//!
//! | claim | what | where | test |
//! |---|---|---|---|
//! | 1, 13 | intersection, overflow, steep slopes found and textured | `extrusion.wgsl` `fs`; for a city `search.wgsl` `fs` | `a_box_is_where_rays_meet_it`; `search_approaches_the_truth` |
//! | 2, 14 | sequential search, then binary | `extrusion_search.wgsl` `search` | `refinements_place_the_surface` |
//! | 3, 15 | slices of the volume, the uppermost first; stops at the first below the map | `search`, its first loop | `more_slices_miss_less` |
//! | 4, 16 | overflow on the polygon extended in its plane | `extrusion.wgsl` `vs`, EXTENSION | `both_overflows_show_the_same` |
//! | 5, 17, 24 | overflow on upright faces at the borders it leaves by | `extrusion.wgsl` `vs`, FACES; [`faces_seen`] | `a_box_is_where_rays_meet_it` |
//! | 6, 18, 25 | tangent spaces of face and polygon | `base_point` | `the_virtual_extension_is_where_the_ray_meets_the_plane` (`overflow.rs`) |
//! | 7, 19, 26 | x' = dx vx / vz, y' = dx vy / vz + dy | `virtual_extension`, in WGSL and in [`virtual_extension`] | the same |
//! | 8, 20, 27 | the added face itself is not drawn | `discard` in `fs` of both shaders | `a_box_is_where_rays_meet_it` |
//! | 9, 21 | steep: the found height against that of the slice above | `is_steep` | `steep_slopes_take_the_facade` |
//! | 10, 22 | a tiled texture on them | `fs`, FACADES; `facade.wgsl` | `steep_slopes_take_the_facade` |
//! | 11, 12 | objects in the order of their distance | `SearchPass::encode`, the farthest tile first; `walk_city`, the nearest first | `search_approaches_the_truth`, `tests/truth.rs` |
//! | 12 | polygons displaced by the global map, details by the local one, both at once | `ground.wgsl` and `search.wgsl` or `exact.wgsl` | `tests/truth.rs` |
//! | 12 | the height direction is the same on neighbouring polygons | up everywhere: `march.wgsl` walks in world space | `tests/light.rs`, `shadows_agree_with_the_ray_caster`; `tests/truth.rs` |
//! | 23 | global map: bare terrain; local map: buildings; texture: orthophotos | a city (`crate::city`) | `tests/light.rs`, `imagery_lies_where_the_survey_has_it` |
//! | | figures 2, 7 and 17 as scenes | [`FIGURES`], `rilievo relief` | `figures_look_as_they_did` |

mod drawer;
mod figures;
mod overflow;

pub use drawer::{
    Extrusion, ExtrusionFrame, ExtrusionMethod, HeightImage, INPUT, Overflow, SHADER, TextureImage,
    draw_extrusion,
};
pub use figures::{FIGURES, Figure, draw_figure};
pub use overflow::{faces_seen, virtual_extension};
