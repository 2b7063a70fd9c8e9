//! Which libraries each shader is linked from.

use crate::gpu::ShaderSource;

macro_rules! text {
    ($path:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path))
    };
}

/// Sum of samples.
pub const ACCUMULATE: ShaderSource = ShaderSource {
    name: "camera/accumulate.wgsl",
    texts: &[text!("fullscreen.wgsl"), text!("camera/accumulate.wgsl")],
};

/// Exposure and tone mapping.
pub const TONEMAP: ShaderSource = ShaderSource {
    name: "camera/tonemap.wgsl",
    texts: &[
        text!("fullscreen.wgsl"),
        text!("lib/tone_curve.wgsl"),
        text!("camera/tonemap.wgsl"),
    ],
};

/// Ghosts.
pub const FLARE: ShaderSource = ShaderSource {
    name: "camera/flare.wgsl",
    texts: &[text!("camera/flare.wgsl")],
};

/// An image laid on the film.
pub const SPRITE: ShaderSource = ShaderSource {
    name: "camera/sprite.wgsl",
    texts: &[text!("camera/sprite.wgsl")],
};

/// Grids of rays.
pub const RAYS: ShaderSource = ShaderSource {
    name: "camera/rays.wgsl",
    texts: &[text!("lib/trace.wgsl"), text!("camera/rays.wgsl")],
};

/// Every shader of the camera.
pub const ALL: [ShaderSource; 5] = [ACCUMULATE, TONEMAP, FLARE, SPRITE, RAYS];
