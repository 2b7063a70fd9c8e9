//! Which libraries each shader is linked from.

use crate::gpu::ShaderSource;

macro_rules! text {
    ($path:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path))
    };
}

/// The ground.
pub const GROUND: ShaderSource = ShaderSource {
    name: "terrain/ground.wgsl",
    texts: &[text!("lib/frame.wgsl"), text!("terrain/ground.wgsl")],
};

/// Empty air before the buildings.
pub const CONE: ShaderSource = ShaderSource {
    name: "relief/cone.wgsl",
    texts: &[
        text!("lib/frame.wgsl"),
        text!("lib/building_map.wgsl"),
        text!("fullscreen.wgsl"),
        text!("relief/cone.wgsl"),
    ],
};

/// Buildings by the exact walk.
pub const EXACT: ShaderSource = ShaderSource {
    name: "relief/exact.wgsl",
    texts: &[
        text!("lib/frame.wgsl"),
        text!("lib/building_map.wgsl"),
        text!("lib/march.wgsl"),
        text!("relief/exact.wgsl"),
    ],
};

/// Buildings as triangles.
pub const POLYGONS: ShaderSource = ShaderSource {
    name: "relief/polygons.wgsl",
    texts: &[text!("lib/frame.wgsl"), text!("relief/polygons.wgsl")],
};

/// Lighting.
pub const SHADE: ShaderSource = ShaderSource {
    name: "relief/shade.wgsl",
    texts: &[
        text!("lib/frame.wgsl"),
        text!("lib/building_map.wgsl"),
        text!("lib/march.wgsl"),
        text!("lib/sky.wgsl"),
        text!("fullscreen.wgsl"),
        text!("relief/shade.wgsl"),
    ],
};

/// Every shader of the relief pass.
pub const ALL: [ShaderSource; 5] = [GROUND, CONE, EXACT, POLYGONS, SHADE];
