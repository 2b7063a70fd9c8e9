// The terrain of all resident tiles. Host: src/scene/ground_tiles.rs.

struct GroundRecord {
    // The south-western tile of the grid that it covers, its level.
    tile: vec2<i32>,
    level: u32,
    layer: u32,
}

@group(1) @binding(3) var<storage, read> ground_tiles: array<GroundRecord>;
// Metres above the vertical datum, a sample a texel, row by row from the south.
@group(1) @binding(4) var heights: texture_2d_array<f32>;
// Highest ground of square blocks, GROUND_BLOCKS along a tile's side on level 0.
@group(1) @binding(5) var ground_bounds: texture_2d_array<f32>;

// The four samples round a lattice cell: south-west, south-east, north-west, north-east.
fn cell_heights(cell: vec2<i32>, layer: u32) -> vec4<f32> {
    return vec4<f32>(
        textureLoad(heights, cell, layer, 0).x,
        textureLoad(heights, cell + vec2<i32>(1, 0), layer, 0).x,
        textureLoad(heights, cell + vec2<i32>(0, 1), layer, 0).x,
        textureLoad(heights, cell + vec2<i32>(1, 1), layer, 0).x,
    );
}

// The lattice cell of a position in samples from the tile's south-west corner.
fn cell_at(position: vec2<f32>) -> vec2<i32> {
    return clamp(vec2<i32>(floor(position)), vec2<i32>(0), vec2<i32>(i32(frame.terrain_side) - 2));
}

// Distance between the samples of a tile of a level, metres.
fn terrain_step(level: u32) -> f32 { return frame.terrain_step_m * f32(1u << level); }

// The DTM's bilinear surface near a position: height above the eye and slope.
struct Surface {
    height: f32,
    slope: vec2<f32>,
}

fn surface_at(position: vec2<f32>, layer: u32, level: u32) -> Surface {
    let cell = cell_at(position);
    let f = clamp(position - vec2<f32>(cell), vec2<f32>(-0.5), vec2<f32>(1.5));
    let h = cell_heights(cell, layer);
    let south = mix(h.x, h.y, f.x);
    let north = mix(h.z, h.w, f.x);
    let slope = vec2<f32>(mix(h.y - h.x, h.w - h.z, f.y), north - south) / terrain_step(level);
    return Surface(mix(south, north, f.y) - frame.eye_elevation, slope);
}
