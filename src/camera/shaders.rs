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
    texts: &[text!("fullscreen.wgsl"), text!("camera/tonemap.wgsl")],
};

/// Every shader of the camera.
pub const ALL: [ShaderSource; 2] = [ACCUMULATE, TONEMAP];
