//! Walls without openings: bricks, ashlar, render, sheet, panels.

use super::canvas::Texel;
use super::noise::{hash, value_noise};

/// A course of bricks or stones.
#[derive(Clone, Copy)]
pub struct Courses {
    /// Length and height of a brick, metres.
    pub brick_m: [f32; 2],
    /// Width of a joint, metres.
    pub joint_m: f32,
    /// Depth of a joint, metres.
    pub depth_m: f32,
    /// How much bricks differ.
    pub variation: f32,
    /// Lightness of joints, by the bricks'.
    pub joint: f32,
}

/// Stretcher bond: every second course is half a brick over. `width_m`: after which it repeats.
pub fn courses([x, y]: [f32; 2], width_m: f32, courses: Courses) -> Texel {
    let Courses {
        brick_m,
        joint_m,
        depth_m,
        variation,
        joint,
    } = courses;
    // A whole number of bricks along the tile.
    let count = (width_m / brick_m[0]).round().max(1.0);
    let length = width_m / count;
    let row = (y / brick_m[1]).floor();
    let shift = 0.5 * (row as i32).rem_euclid(2) as f32;
    let along = x / length + shift;
    let column = (along.floor() as i32).rem_euclid(count as i32);
    let (in_x, in_y) = (along.fract() * length, y - row * brick_m[1]);
    let is_joint = in_x < joint_m || in_y < joint_m;
    let shade = 1.0 + variation * (hash(column as u32, row as u32, 7) - 0.5);
    match is_joint {
        true => Texel {
            tint: 0.6,
            ..Texel::wall(joint, -depth_m)
        },
        false => Texel::wall(shade, 0.0),
    }
}

/// Render: nearly even.
pub fn render([x, y]: [f32; 2], width_m: f32) -> Texel {
    let cloudy = value_noise([x / width_m * 8.0, y * 2.0], 8, 3);
    let grain = value_noise([x / width_m * 96.0, y * 30.0], 96, 4);
    Texel::wall(
        0.97 + 0.05 * (cloudy - 0.5) + 0.03 * (grain - 0.5),
        0.0008 * grain,
    )
}

/// Corrugated sheet: vertical waves.
pub fn corrugated([x, y]: [f32; 2], width_m: f32) -> Texel {
    let waves = (width_m / 0.2).round();
    let phase = x / width_m * waves * std::f32::consts::TAU;
    let streak = value_noise([x / width_m * 48.0, y * 0.4], 48, 9);
    Texel::wall(
        0.96 + 0.08 * (streak - 0.5) + 0.03 * phase.cos(),
        0.012 * phase.sin(),
    )
}

/// Panels with joints between: `panel_m` wide and high.
pub fn panels(position: [f32; 2], width_m: f32, panel_m: [f32; 2]) -> Texel {
    let count = (width_m / panel_m[0]).round().max(1.0);
    let stain = value_noise([position[0] / width_m * 12.0, position[1] * 0.7], 12, 5);
    let texel = courses(
        [position[0], position[1]],
        width_m,
        Courses {
            brick_m: [width_m / count, panel_m[1]],
            joint_m: 0.025,
            depth_m: 0.012,
            variation: 0.05,
            joint: 0.55,
        },
    );
    texel.scaled(0.96 + 0.10 * (stain - 0.5))
}
