// The ground: lattice positions displaced by the DTM ("global vertex displacement", KR 10-0738500).
// The vertex index is the index of a mesh position; grid and TIN differ in their index buffers alone.

struct GroundVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec3<f32>,
    // In samples from the tile's south-west corner.
    @location(1) position: vec2<f32>,
    @location(2) @interpolate(flat) layer: u32,
    @location(3) @interpolate(flat) level: u32,
}

// The bilinear surface at a mesh position. Weights 0 and 1 give the sample itself, so that tiles agree on their border.
fn mesh_height(position: vec2<i32>, parts: i32, layer: u32) -> f32 {
    let cell = min(position / parts, vec2<i32>(i32(frame.terrain_side) - 2));
    let f = vec2<f32>(position - cell * parts) / f32(parts);
    let h = cell_heights(cell, layer);
    return (h.x * (1.0 - f.x) + h.y * f.x) * (1.0 - f.y) + (h.z * (1.0 - f.x) + h.w * f.x) * f.y;
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> GroundVertex {
    let tile = ground_tiles[instance];
    let parts = i32(frame.mesh_parts);
    let last = (i32(frame.terrain_side) - 1) * parts;
    // Vertices of the skirt hang below those of the mesh's border.
    let number = i32(index & (SKIRT_BIT - 1u));
    let position = vec2<i32>(number % (last + 1), number / (last + 1));
    // The far border is the next tile's near one, rounding included: no gap opens between tiles.
    let next = position / last;
    let step_m = terrain_step(tile.level);
    let plan = tile_corner(tile.tile + (next << vec2<u32>(tile.level))) + vec2<f32>(position - next * last) * (step_m / f32(parts));
    let drop = select(0.0, SKIRT_M * f32(1u << tile.level), (index & SKIRT_BIT) != 0u);
    let at = vec3<f32>(plan, mesh_height(position, parts, tile.layer) - frame.eye_elevation - drop);
    let in_samples = vec2<f32>(position) / f32(parts);
    return GroundVertex(frame.clip_from_eye_relative * vec4<f32>(at, 1.0), at, in_samples, tile.layer, tile.level);
}

struct GroundSurface {
    // Metres along the view ray.
    @location(0) distance: f32,
    @location(1) normal: u32,
}

// Newton steps from the triangle to the DTM itself.
const MAX_NEWTON_STEPS: i32 = 8;
// Good enough, metres.
const NEAR_ENOUGH_M: f32 = 0.01;
// Least loss of height above the ground per metre along the ray: below it the ray grazes and the triangle stays.
const MIN_CLOSING: f32 = 0.004;
// Farthest from the triangle, metres along the ray.
const MAX_CARRY_M: f32 = 40.0;

@fragment
fn fs(in: GroundVertex) -> GroundSurface {
    // The triangle stands for the DTM within the mesh's error; from there the ray is carried on to the DTM's own
    // bilinear surface, so that the mesh may stay coarse ("per-pixel displacement" of the ground).
    let on_mesh = length(in.at);
    let direction = in.at / on_mesh;
    var t = on_mesh;
    var surface = surface_at(in.position, in.layer, in.level);
    var above = in.at.z - surface.height;
    let above_on_mesh = abs(above);
    for (var i = 0; i < MAX_NEWTON_STEPS; i += 1) {
        let closing = dot(surface.slope, direction.xy) - direction.z;
        if abs(above) < NEAR_ENOUGH_M || closing < MIN_CLOSING { break; }
        t = clamp(t + above / closing, on_mesh - MAX_CARRY_M, on_mesh + MAX_CARRY_M);
        let at = direction * t;
        surface = surface_at(in.position + (at.xy - in.at.xy) / terrain_step(in.level), in.layer, in.level);
        above = at.z - surface.height;
    }
    // Over a crest the steps may lead nowhere: then the triangle stands.
    if (abs(above) > 0.05 && abs(above) > 0.25 * above_on_mesh) || t < 0.5 * on_mesh { t = on_mesh; }
    return GroundSurface(t, pack_normal(normalize(vec3<f32>(-surface.slope, 1.0))));
}
