//! The patent's own figures as scenes: a box on a square.

use glam::{DVec2, DVec3};

use super::drawer::{Extrusion, ExtrusionMethod, HeightImage, Overflow, TextureImage, draw_extrusion};
use crate::gpu::{Gpu, GpuError};
use crate::material::{FacadeBand, FacadeStyle, TILE_SIZE, paint_facade};
use crate::relief::SearchParameters;
use crate::space::{Pose, Projection};

/// A figure.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// Its number and letter.
    pub name: &'static str,
    /// What it shows.
    pub shows: &'static str,
    method: ExtrusionMethod,
    overflow: Overflow,
    /// Height of the box, metres.
    height_m: f64,
}

const fn figure(
    name: &'static str,
    shows: &'static str,
    method: ExtrusionMethod,
    overflow: Overflow,
    height_m: f64,
) -> Figure {
    Figure {
        name,
        shows,
        method,
        overflow,
        height_m,
    }
}

/// All of them: figure 7 (a) to (f), then figure 2 (b) and (c), the method before the patent.
pub const FIGURES: [Figure; 8] = [
    figure(
        "7a",
        "the texture alone",
        ExtrusionMethod::Flat,
        Overflow::None,
        9.0,
    ),
    figure(
        "7b",
        "raised, without overflow",
        ExtrusionMethod::Raised,
        Overflow::None,
        9.0,
    ),
    figure(
        "7c",
        "twice as high: cut",
        ExtrusionMethod::Raised,
        Overflow::None,
        18.0,
    ),
    figure(
        "7d",
        "overflow on one face",
        ExtrusionMethod::Raised,
        Overflow::OneFace,
        18.0,
    ),
    figure(
        "7e",
        "overflow on both faces",
        ExtrusionMethod::Raised,
        Overflow::Faces,
        18.0,
    ),
    figure(
        "7f",
        "a facade on steep slopes",
        ExtrusionMethod::Facades,
        Overflow::Faces,
        18.0,
    ),
    figure(
        "2b",
        "before: sunk below the plane",
        ExtrusionMethod::Sunken,
        Overflow::None,
        9.0,
    ),
    figure(
        "2c",
        "the higher, the more is lost",
        ExtrusionMethod::Sunken,
        Overflow::None,
        18.0,
    ),
];

/// Side of the square, metres, and of its images, pixels.
const SQUARE_M: f64 = 30.0;
const SIDE: u32 = 256;
/// The box's borders, parts of the square.
const BOX: [f32; 4] = [0.30, 0.34, 0.74, 0.70];

fn is_in_box(u: f32, v: f32, inset: f32) -> bool {
    (BOX[0] + inset..BOX[2] - inset).contains(&u) && (BOX[1] + inset..BOX[3] - inset).contains(&v)
}

/// Texture and displacement map of the square.
fn square() -> (TextureImage, HeightImage) {
    let places = || (0..SIDE * SIDE).map(|k| [k % SIDE, k / SIDE].map(|c| (c as f32 + 0.5) / SIDE as f32));
    let colour = |[u, row]: [f32; 2]| {
        let v = 1.0 - row;
        let grid = |c: f32| (c * 10.0).fract() < 0.05;
        match () {
            () if is_in_box(u, v, 0.012) && ((u - v) * 26.0).rem_euclid(1.0) < 0.14 => [150, 70, 48, 255],
            () if is_in_box(u, v, 0.012) => [190, 92, 62, 255],
            () if is_in_box(u, v, 0.0) => [226, 214, 190, 255],
            () if (0.47..0.57).contains(&u) && v < BOX[1] => [196, 188, 172, 255],
            () if grid(u) || grid(v) => [112, 146, 92, 255],
            () => [128, 164, 104, 255],
        }
    };
    let height = |[u, row]: [f32; 2]| f32::from(u8::from(is_in_box(u, 1.0 - row, 0.0)));
    let texture = TextureImage {
        size: [SIDE; 2],
        rgba: places().map(colour).collect(),
    };
    let map = HeightImage {
        size: [SIDE; 2],
        values: places().map(height).collect(),
    };
    (texture, map)
}

/// Two bays and a storey of a rendered house, rows from above.
fn facade() -> TextureImage {
    let canvas = paint_facade(FacadeStyle::Render, FacadeBand::Middle);
    let colours = FacadeStyle::Render.colours()[0];
    let rows = canvas.rows_from_above(colours);
    TextureImage {
        size: TILE_SIZE.map(|side| side as u32),
        rgba: rows,
    }
}

/// Draws one, 8-bit sRGB RGBA.
///
/// # Errors
/// When the device fails.
pub fn draw_figure(gpu: &Gpu, figure: &Figure, size: [u32; 2]) -> Result<Vec<u8>, GpuError> {
    let ((texture, height), facade) = (square(), facade());
    let eye = DVec3::new(-14.0, -34.0, 30.0);
    let pose = Pose::looking_at(eye, DVec3::new(17.0, 17.0, 1.0));
    let projection = Projection::new(pose, size, 40_f64.to_radians());
    let extrusion = Extrusion {
        texture: &texture,
        height: &height,
        facade: &facade,
        size_m: DVec2::splat(SQUARE_M),
        height_m: figure.height_m,
        facade_m: 6.0,
        method: figure.method,
        overflow: figure.overflow,
        search: SearchParameters {
            slices: 256,
            ..SearchParameters::default()
        },
    };
    draw_extrusion(gpu, &extrusion, &projection)
}
