//! Flat roofs' surfaces, squares of some metres, each of them twice in a tile. Deterministic.

use super::RoofStyle;
use super::brickwork::{Courses, courses};
use super::canvas::{Canvas, Texel, WALL_GREY};
use super::noise::{hash, value_noise};

/// Length and height of a roof's tile, metres: u runs along the building.
pub const ROOF_M: [f32; 2] = [16.0, 8.0];

/// Paints a kind of roof.
pub fn paint_roof(style: RoofStyle) -> Canvas {
    let cloud = |[x, y]: [f32; 2], cells: u32, seed: u32| {
        let scale = cells as f32 / ROOF_M[0];
        // Half as many cells up as across: the noise repeats after them too.
        value_noise([x * scale, y * scale], cells / 2, seed)
    };
    let tiles = |brick_m: [f32; 2], joint_m: f32| Courses {
        brick_m,
        joint_m,
        depth_m: 0.02,
        variation: 0.30,
        joint: 0.55,
    };
    let colour = |texel: Texel, albedo: [f32; 3]| Texel {
        albedo: std::array::from_fn(|k| texel.albedo[k] / WALL_GREY * albedo[k]),
        tint: 0.0,
        ..texel
    };
    Canvas::new(ROOF_M, |position| {
        let broad = cloud(position, 8, 41);
        let fine = cloud(position, 128, 42);
        let [x, y] = position;
        match style {
            RoofStyle::Gravel => {
                let speck = hash((x * 16.0) as u32, (y * 16.0) as u32, 43);
                // Walkways of slabs, where one goes to look after the roof.
                let slab = y < 0.5 && (x % 0.5) > 0.03;
                let shade = 0.88 + 0.14 * (broad - 0.5) + 0.30 * (speck - 0.5) + 0.14 * (fine - 0.5);
                let colour = if slab {
                    [0.40, 0.395, 0.38]
                } else {
                    [0.33, 0.315, 0.29]
                };
                Texel::dull(colour.map(|c| c * shade), 0.01 * speck)
            }
            RoofStyle::Tiles => {
                let tile = courses(position, ROOF_M[0], tiles([0.25, 0.25], 0.05));
                let worn = 0.85 + 0.30 * (broad - 0.5);
                colour(tile, [0.36, 0.165, 0.095].map(|c| c * worn))
            }
            RoofStyle::Slate => {
                let slate = courses(position, ROOF_M[0], tiles([0.33, 0.33], 0.04));
                let worn = 0.95 + 0.25 * (broad - 0.5);
                colour(slate, [0.15, 0.155, 0.17].map(|c| c * worn))
            }
            RoofStyle::Metal => {
                let seam = (y / 0.5).fract() < 0.10;
                let shade = 0.95 + 0.12 * (broad - 0.5);
                let height = if seam { 0.03 } else { 0.0 };
                Texel::dull(
                    [0.36, 0.38, 0.39].map(|c| c * shade * if seam { 1.15 } else { 1.0 }),
                    height,
                )
            }
            RoofStyle::Membrane => {
                let weld = (y / 2.0).fract() < 0.02 || (x / 8.0).fract() < 0.006;
                // Where water stood, softly.
                let puddle = (0.6 * broad + 0.4 * cloud(position, 16, 44) - 0.5).max(0.0);
                let shade = 0.95 + 0.06 * (broad - 0.5) - 0.35 * puddle - if weld { 0.12 } else { 0.0 };
                Texel::dull(
                    [0.52, 0.515, 0.49].map(|c| c * shade),
                    if weld { 0.004 } else { 0.0 },
                )
            }
        }
    })
}
