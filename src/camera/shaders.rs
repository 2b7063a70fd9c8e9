//! Which libraries each shader is linked from.

use super::flare::{MASK_EXTENT, MAX_SOFTNESS, MIN_SOFTNESS, SOFT_EXTENT, SOFT_MARGIN, SOFT_MASKS};
use super::ray_bundles::{LOST, REFLECTS, STOP, WORKGROUP};
use super::tone_curve::START_COMPRESSION;
use super::vignetting::FALLOFF_PLACES;
use crate::gpu::{Constant, ConstantValue, ShaderSource, shader_file};

/// What these shaders share with Rust.
const CONSTANTS: &[Constant] = &[
    ("REFLECTS", ConstantValue::Uint(REFLECTS)),
    ("STOP", ConstantValue::Uint(STOP)),
    ("LOST", ConstantValue::Float(LOST)),
    ("WORKGROUP", ConstantValue::Uint(WORKGROUP)),
    ("FALLOFF_PLACES", ConstantValue::Float(FALLOFF_PLACES as f32)),
    ("SOFT_MARGIN", ConstantValue::Float(SOFT_MARGIN as f32)),
    ("MASK_EXTENT", ConstantValue::Float(MASK_EXTENT as f32)),
    ("SOFT_EXTENT", ConstantValue::Float(SOFT_EXTENT as f32)),
    ("SOFT_MASKS", ConstantValue::Float(SOFT_MASKS as f32)),
    ("MIN_SOFTNESS", ConstantValue::Float(MIN_SOFTNESS as f32)),
    ("MAX_SOFTNESS", ConstantValue::Float(MAX_SOFTNESS as f32)),
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

/// Mean of a moving view's frames.
pub const TEMPORAL: ShaderSource = ShaderSource {
    name: "camera/temporal.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("fullscreen.wgsl"),
        shader_file!("camera/temporal.wgsl"),
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
    files: &[
        shader_file!("camera/sharp_iris.wgsl"),
        shader_file!("camera/ghost.wgsl"),
    ],
};

/// Ghosts softened in the iris. Apart from the others: what lies in a branch may cost where it is not taken.
pub const SOFT_GHOST: ShaderSource = ShaderSource {
    name: "camera/ghost.wgsl, soft",
    constants: CONSTANTS,
    files: &[
        shader_file!("camera/soft_iris.wgsl"),
        shader_file!("camera/ghost.wgsl"),
    ],
};

/// An image laid on the film.
pub const SPRITE: ShaderSource = ShaderSource {
    name: "camera/sprite.wgsl",
    constants: CONSTANTS,
    files: &[shader_file!("camera/sprite.wgsl")],
};

/// Ghosts of a disc of light.
pub const SOFTEN: ShaderSource = ShaderSource {
    name: "camera/soften.wgsl",
    constants: CONSTANTS,
    files: &[shader_file!("camera/soften.wgsl")],
};

/// Ghosts on texels half or twice as large.
pub const RESAMPLE: ShaderSource = ShaderSource {
    name: "camera/resample.wgsl",
    constants: CONSTANTS,
    files: &[shader_file!("camera/resample.wgsl")],
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
pub const ALL: [ShaderSource; 9] = [
    ACCUMULATE, TEMPORAL, TONE_MAP, GHOST, SOFT_GHOST, SOFTEN, RESAMPLE, SPRITE, RAYS,
];
