//! Which libraries each shader is linked from.

use super::ray_bundles::{LOST, REFLECTS, STOP, WORKGROUP};
use super::tone_curve::START_COMPRESSION;
use crate::gpu::{Constant, ConstantValue, ShaderSource, shader_file};

/// What these shaders share with Rust.
const CONSTANTS: &[Constant] = &[
    ("REFLECTS", ConstantValue::Uint(REFLECTS)),
    ("STOP", ConstantValue::Uint(STOP)),
    ("LOST", ConstantValue::Float(LOST)),
    ("WORKGROUP", ConstantValue::Uint(WORKGROUP)),
    ("START_COMPRESSION", ConstantValue::Float(START_COMPRESSION)),
];

/// Sum of samples.
pub const ACCUMULATE: ShaderSource = ShaderSource {
    name: "camera/accumulate.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("fullscreen.wgsl"),
        shader_file!("camera/accumulate.wgsl"),
    ],
};

/// Exposure and tone mapping.
pub const TONE_MAP: ShaderSource = ShaderSource {
    name: "camera/tone_map.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("fullscreen.wgsl"),
        shader_file!("lib/tone_curve.wgsl"),
        shader_file!("camera/tone_map.wgsl"),
    ],
};

/// Ghosts.
pub const GHOST: ShaderSource = ShaderSource {
    name: "camera/ghost.wgsl",
    constants: CONSTANTS,
    files: &[shader_file!("camera/ghost.wgsl")],
};

/// An image laid on the film.
pub const SPRITE: ShaderSource = ShaderSource {
    name: "camera/sprite.wgsl",
    constants: CONSTANTS,
    files: &[shader_file!("camera/sprite.wgsl")],
};

/// Grids of rays.
pub const RAYS: ShaderSource = ShaderSource {
    name: "camera/ray_bundles.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("lib/trace.wgsl"),
        shader_file!("camera/ray_bundles.wgsl"),
    ],
};

/// Every shader of the camera.
pub const ALL: [ShaderSource; 5] = [ACCUMULATE, TONE_MAP, GHOST, SPRITE, RAYS];
