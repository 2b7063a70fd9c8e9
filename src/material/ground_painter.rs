//! The grain of ground that no imagery shows: a square of some metres, twice in a tile like a roof's. Deterministic.
//! What its channels mean: `shaders/lib/bare_ground.wgsl`.

use super::canvas::{Canvas, TILE_SIZE, Texel};
use super::noise::{hash, value_noise};
use super::roof_painter::ROOF_M;

/// Slabs of paving along a tile's sides, and the width of a joint between two, texels.
const SLABS: [f32; 2] = [8.0, 4.0];
const JOINT_TEXELS: f32 = 1.0;

/// Red: how light paving is; green: tufts; blue: blotches; glass: how light soil is; tint: joints of paving.
pub fn paint_ground() -> Canvas {
    Canvas::new(ROOF_M, |position| {
        let [x, y] = position;
        let noise = |cells: u32, seed: u32| {
            let scale = cells as f32 / ROOF_M[0];
            value_noise([x * scale, y * scale], cells / 2, seed)
        };
        let step = |low: f32, high: f32, value: f32| {
            let part = ((value - low) / (high - low)).clamp(0.0, 1.0);
            part * part * (3.0 - 2.0 * part)
        };
        let speck = hash((x * 16.0) as u32, (y * 16.0) as u32, 51);
        let blotch = 0.55 * noise(8, 52) + 0.3 * noise(16, 53) + 0.15 * noise(32, 54);
        // Paving: stone in binder, oil, seams that were filled.
        let seam = 1.0 - step(0.004, 0.014, (noise(6, 55) - 0.5).abs());
        let oil = step(0.62, 0.8, noise(20, 56));
        let paving = 0.62 + 0.10 * (speck - 0.5) + 0.10 * (noise(128, 57) - 0.5) + 0.16 * (blotch - 0.5)
            - 0.06 * seam
            - 0.05 * oil;
        let tufts =
            step(0.42, 0.70, 0.6 * noise(64, 58) + 0.4 * noise(128, 59)) * step(0.30, 0.62, noise(24, 60));
        let stones = if speck > 0.97 { 0.12 } else { 0.0 };
        let soil = 0.66
            + 0.10 * (speck - 0.5)
            + 0.14 * (noise(128, 61) - 0.5)
            + 0.14 * (noise(32, 62) - 0.5)
            + stones;
        let to_joint = |k: usize| {
            let part = (position[k] / ROOF_M[k] * SLABS[k]).fract();
            (part.min(1.0 - part) / SLABS[k]) * TILE_SIZE[k] as f32
        };
        let joint = 1.0
            - step(
                0.5 * JOINT_TEXELS,
                0.5 * JOINT_TEXELS + 1.0,
                to_joint(0).min(to_joint(1)),
            );
        Texel {
            albedo: [paving, 0.9 * tufts, blotch],
            height_m: 0.012 * (noise(128, 57) + 0.6 * speck),
            glass: soil,
            tint: joint,
        }
    })
}
