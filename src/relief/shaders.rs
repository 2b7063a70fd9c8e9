//! Which libraries each shader is linked from.

use super::constants::CONSTANTS;
use crate::gpu::ShaderSource;

macro_rules! file {
    ($path:literal) => {
        (
            $path,
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path)),
        )
    };
}

/// The ground.
pub const GROUND: ShaderSource = ShaderSource {
    name: "terrain/ground.wgsl",
    constants: CONSTANTS,
    files: &[
        file!("lib/frame.wgsl"),
        file!("lib/building_map.wgsl"),
        file!("lib/terrain.wgsl"),
        file!("terrain/ground.wgsl"),
    ],
};

/// Empty air before the buildings.
pub const CONE: ShaderSource = ShaderSource {
    name: "relief/cone.wgsl",
    constants: CONSTANTS,
    files: &[
        file!("lib/frame.wgsl"),
        file!("lib/building_map.wgsl"),
        file!("fullscreen.wgsl"),
        file!("relief/cone.wgsl"),
    ],
};

/// Buildings by the exact walk.
pub const EXACT: ShaderSource = ShaderSource {
    name: "relief/exact.wgsl",
    constants: CONSTANTS,
    files: &[
        file!("lib/frame.wgsl"),
        file!("lib/building_map.wgsl"),
        file!("lib/march.wgsl"),
        file!("relief/exact.wgsl"),
    ],
};

/// Buildings as triangles.
pub const POLYGONS: ShaderSource = ShaderSource {
    name: "relief/polygons.wgsl",
    constants: CONSTANTS,
    files: &[file!("lib/frame.wgsl"), file!("relief/polygons.wgsl")],
};

/// Lighting.
pub const SHADE: ShaderSource = ShaderSource {
    name: "relief/shade.wgsl",
    constants: CONSTANTS,
    files: &[
        file!("lib/frame.wgsl"),
        file!("lib/building_map.wgsl"),
        file!("lib/terrain.wgsl"),
        file!("lib/march.wgsl"),
        file!("lib/ground_march.wgsl"),
        file!("lib/sky.wgsl"),
        file!("fullscreen.wgsl"),
        file!("relief/shade.wgsl"),
    ],
};

/// Every shader of the relief pass.
pub const ALL: [ShaderSource; 5] = [GROUND, CONE, EXACT, POLYGONS, SHADE];
