//! Which libraries each shader is linked from.

use super::ray_bundles::{LOST, REFLECTS, STOP, WORKGROUP};
use super::tone_curve::START_COMPRESSION;
use crate::gpu::{Constant, ConstantValue, ShaderSource};

macro_rules! file {
    ($path:literal) => {
        (
            $path,
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path)),
        )
    };
}

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
    files: &[file!("fullscreen.wgsl"), file!("camera/accumulate.wgsl")],
};

/// Exposure and tone mapping.
pub const TONEMAP: ShaderSource = ShaderSource {
    name: "camera/tonemap.wgsl",
    constants: CONSTANTS,
    files: &[
        file!("fullscreen.wgsl"),
        file!("lib/tone_curve.wgsl"),
        file!("camera/tonemap.wgsl"),
    ],
};

/// Ghosts.
pub const FLARE: ShaderSource = ShaderSource {
    name: "camera/flare.wgsl",
    constants: CONSTANTS,
    files: &[file!("camera/flare.wgsl")],
};

/// An image laid on the film.
pub const SPRITE: ShaderSource = ShaderSource {
    name: "camera/sprite.wgsl",
    constants: CONSTANTS,
    files: &[file!("camera/sprite.wgsl")],
};

/// Grids of rays.
pub const RAYS: ShaderSource = ShaderSource {
    name: "camera/ray_bundles.wgsl",
    constants: CONSTANTS,
    files: &[file!("lib/trace.wgsl"), file!("camera/ray_bundles.wgsl")],
};

/// Every shader of the camera.
pub const ALL: [ShaderSource; 5] = [ACCUMULATE, TONEMAP, FLARE, SPRITE, RAYS];
