//! Which libraries each shader is linked from.

use super::constants::CONSTANTS;
use crate::gpu::{ShaderSource, shader_file};

/// The ground.
pub const GROUND: ShaderSource = ShaderSource {
    name: "relief/ground.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("lib/search_parameters.wgsl"),
        shader_file!("lib/frame.wgsl"),
        shader_file!("lib/tile_table.wgsl"),
        shader_file!("lib/building_map.wgsl"),
        shader_file!("lib/terrain.wgsl"),
        shader_file!("relief/ground.wgsl"),
    ],
};

/// Empty air before the buildings.
pub const CONE: ShaderSource = ShaderSource {
    name: "relief/cone.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("lib/search_parameters.wgsl"),
        shader_file!("lib/frame.wgsl"),
        shader_file!("lib/tile_table.wgsl"),
        shader_file!("lib/building_map.wgsl"),
        shader_file!("fullscreen.wgsl"),
        shader_file!("relief/cone.wgsl"),
    ],
};

/// Buildings by the exact walk.
pub const EXACT: ShaderSource = ShaderSource {
    name: "relief/exact.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("lib/search_parameters.wgsl"),
        shader_file!("lib/frame.wgsl"),
        shader_file!("lib/tile_table.wgsl"),
        shader_file!("lib/building_map.wgsl"),
        shader_file!("lib/march.wgsl"),
        shader_file!("lib/building_texels.wgsl"),
        shader_file!("lib/volume.wgsl"),
        shader_file!("relief/exact.wgsl"),
    ],
};

/// Buildings by the patent's search.
pub const SEARCH: ShaderSource = ShaderSource {
    name: "relief/search.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("lib/search_parameters.wgsl"),
        shader_file!("lib/frame.wgsl"),
        shader_file!("lib/tile_table.wgsl"),
        shader_file!("lib/building_map.wgsl"),
        shader_file!("lib/map_height.wgsl"),
        shader_file!("lib/march.wgsl"),
        shader_file!("lib/building_texels.wgsl"),
        shader_file!("lib/volume.wgsl"),
        shader_file!("lib/extrusion_search.wgsl"),
        shader_file!("relief/search.wgsl"),
    ],
};

/// Buildings as triangles.
pub const POLYGONS: ShaderSource = ShaderSource {
    name: "relief/polygons.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("lib/search_parameters.wgsl"),
        shader_file!("lib/frame.wgsl"),
        shader_file!("lib/building_texels.wgsl"),
        shader_file!("relief/polygons.wgsl"),
    ],
};

/// Rays of light from all round.
pub const AMBIENT: ShaderSource = ShaderSource {
    name: "relief/ambient.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("lib/search_parameters.wgsl"),
        shader_file!("lib/frame.wgsl"),
        shader_file!("lib/tile_table.wgsl"),
        shader_file!("lib/building_map.wgsl"),
        shader_file!("lib/terrain.wgsl"),
        shader_file!("lib/march.wgsl"),
        shader_file!("lib/random.wgsl"),
        shader_file!("lib/surface_rays.wgsl"),
        shader_file!("fullscreen.wgsl"),
        shader_file!("relief/ambient.wgsl"),
    ],
};

/// Lighting.
pub const LIGHT: ShaderSource = ShaderSource {
    name: "relief/light.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("lib/search_parameters.wgsl"),
        shader_file!("lib/frame.wgsl"),
        shader_file!("lib/tile_table.wgsl"),
        shader_file!("lib/building_map.wgsl"),
        shader_file!("lib/terrain.wgsl"),
        shader_file!("lib/march.wgsl"),
        shader_file!("lib/ground_march.wgsl"),
        shader_file!("lib/sun_bounds.wgsl"),
        shader_file!("lib/sky.wgsl"),
        shader_file!("lib/random.wgsl"),
        shader_file!("lib/surface_rays.wgsl"),
        shader_file!("lib/facade.wgsl"),
        shader_file!("lib/parapet.wgsl"),
        shader_file!("lib/pitched_roof.wgsl"),
        shader_file!("lib/streets.wgsl"),
        shader_file!("lib/bare_ground.wgsl"),
        shader_file!("fullscreen.wgsl"),
        shader_file!("relief/light.wgsl"),
    ],
};

/// Every shader of the relief pass.
pub const ALL: [ShaderSource; 7] = [GROUND, CONE, EXACT, SEARCH, POLYGONS, AMBIENT, LIGHT];
