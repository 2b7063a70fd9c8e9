// One frame's view and city. Host: src/relief/frame_uniforms.rs (a test compares the layouts).
// Positions called `at` are eye-relative world: metres east, north and up of the eye.

struct Frame {
    clip_from_eye_relative: mat4x4<f32>,
    // The ray through normalised device coordinates (x, y) of the part of the image that is drawn is forward + x * across + y * upward.
    forward: vec4<f32>,
    across: vec4<f32>,
    upward: vec4<f32>,
    // Unit vector towards the sun; half the angle that its disc spans, radians.
    sun: vec4<f32>,
    // Irradiance of the sun on a surface facing it, linear sRGB; the part of it that
    // its disc in the sky has.
    sun_irradiance: vec4<f32>,
    // How `search.wgsl` searches.
    search: SearchParameters,
    // The grid of the sun bounds: its centre in plan from the eye, its shear, the side of a cell of the finest level; its axes, towards
    // the sun and across.
    sun_grid: vec4<f32>,
    sun_axes: vec4<f32>,
    // The grid of the streets: its centre in plan from the eye, the side of a cell of the finest level, levels, 0 = none.
    street_grid: vec4<f32>,
    // Coefficients of the sky's irradiance (`sky_irradiance`).
    sky_light: array<vec4<f32>, 9>,
    // Irradiance by walls across a street that fill a surface's view, away from the sun and facing it; w of the first is 1 where the
    // survey has orthophotos.
    wall_light: vec4<f32>,
    sunny_wall_light: vec4<f32>,
    // The eye within its tile, metres; elevation of the eye; side of a tile.
    eye_in_tile: vec2<f32>,
    eye_elevation: f32,
    tile_m: f32,
    // Column and row of the eye's tile (may lie outside the grid).
    eye_tile: vec2<i32>,
    // Columns and rows of the grid.
    grid: vec2<i32>,
    // Size of the part of the image that is drawn, pixels; sub-pixel offset of the sample, pixels.
    size: vec2<f32>,
    jitter: vec2<f32>,
    texel_m: f32,
    // log2 of the texels along a tile's side.
    tile_texels_log2: u32,
    // Highest roof and lowest ground of the city's tiles with buildings, metres above the eye.
    max_roof: f32,
    min_ground: f32,
    // Distance between terrain samples, metres; samples along a tile's side.
    terrain_step_m: f32,
    terrain_side: u32,
    // Number of this sample, from 0.
    sample: u32,
    // Angle of a pixel at the image's centre, radians.
    pixel_angle: f32,
    imagery_side: f32,
    // Nodes of a tile's pyramid.
    pyramid_nodes: u32,
    // Highest ground of the city, metres above the eye.
    max_ground: f32,
    // Parts that a terrain mesh divides a cell's side into.
    mesh_parts: u32,
    // Layers that are not drawn: HIDES_BUILDINGS, HIDES_FACADES, HIDES_IMAGERY.
    hidden: u32,
    // Levels of the sun bounds, 0 = none.
    sun_levels: u32,
    // The layer of the finest level of the streets.
    street_layer: u32,
    padding_3: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;

// Unit direction of the ray through a pixel (fragment position: its centre).
fn ray_direction(pixel: vec2<f32>) -> vec3<f32> {
    let ndc = (pixel + frame.jitter) / frame.size * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0);
    return normalize(frame.forward.xyz + ndc.x * frame.across.xyz + ndc.y * frame.upward.xyz);
}

// South-west corner of a tile, eye-relative.
fn tile_corner(tile: vec2<i32>) -> vec2<f32> {
    return vec2<f32>(tile - frame.eye_tile) * frame.tile_m - frame.eye_in_tile;
}

// A unit vector in 32 bits: octahedral map (Cigolle et al. 2014, JCGT 3(2)), 16 bits a coordinate.
fn pack_normal(normal: vec3<f32>) -> u32 {
    let p = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
    let folded = (1.0 - abs(p.yx)) * select(vec2<f32>(-1.0), vec2<f32>(1.0), p >= vec2<f32>(0.0));
    return pack2x16snorm(select(p, folded, normal.z < 0.0));
}

fn unpack_normal(word: u32) -> vec3<f32> {
    let p = unpack2x16snorm(word);
    let z = 1.0 - abs(p.x) - abs(p.y);
    let folded = (1.0 - abs(p.yx)) * select(vec2<f32>(-1.0), vec2<f32>(1.0), p >= vec2<f32>(0.0));
    return normalize(vec3<f32>(select(p, folded, z < 0.0), z));
}
