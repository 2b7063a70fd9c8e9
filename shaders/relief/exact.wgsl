// Buildings raised out of the building map, drawn on overflow faces.
//
// The terrain's own polygons do not cover what rises above them: a roof before the sky, a tower over the tile's
// border. KR 10-0738500 adds faces for what overflows. Here they are the faces of the tiles' volume (its border
// upright, from the lowest ground to the highest roof) that face AWAY from the viewer: those cover every pixel whose
// ray meets the volume, also with the eye inside it or above the horizon. Only the raised shape is drawn, never
// the face.
//
// Where two tiles meet no face is needed: a ray that leaves one tile goes on in the next, nearest first (`walk_city`), so
// that each pixel walks once and nothing is cut at a tile's border. What is left are the faces on the border of all tiles.

@group(2) @binding(0) var ground_distance: texture_2d<f32>;
// Metres without a building, per block of pixels (`cone.wgsl`).
@group(2) @binding(1) var cone_distance: texture_2d<f32>;

@vertex
fn vs_overflow(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = volume_corner(index);
    let plan = mix(tile_corner(vec2<i32>(0)), tile_corner(frame.grid), corner.xy);
    let height = mix(frame.min_ground, frame.max_roof, corner.z);
    return frame.clip_from_eye_relative * vec4<f32>(plan, height, 1.0);
}

// The last face: the whole picture, behind all others. Where a face is cut off at the near plane a rasteriser may leave
// pixels out along its edges; this one catches them.
@vertex
fn vs_last(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 1.0e-12, 1.0);
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> BuildingTexels {
    let ray = make_ray(vec3<f32>(0.0), ray_direction(position.xy));
    let t_ground = textureLoad(ground_distance, vec2<i32>(position.xy), 0).x;
    let t_cone = textureLoad(cone_distance, vec2<i32>(position.xy) / CONE_PIXELS, 0).x;
    let hit = walk_city(ray, t_cone, t_ground);
    // The face itself is never drawn: without a hit the surface stays at FAR, which shows nothing. It is not discarded,
    // so that its depth keeps the face behind it from walking the same ray again.
    if hit.t >= FAR { return BuildingTexels(vec4<u32>(bitcast<u32>(FAR), 0u, 0u, 0u), vec4<u32>(0u)); }
    let roof = roof_at(hit.roof_place);
    let place = facade_position(hit);
    let base = roof.base_m - frame.eye_elevation;
    let facade = bitcast<vec3<u32>>(vec3<f32>(place.bays_per_m, base, roof.roof_m - roof.base_m));
    let normal = pack_normal(hit_normal(hit, ray));
    let bays_or_roof = select(bitcast<u32>(place.bays), hit.roof_place, hit.edge == ROOF && hit.word_base != 0u);
    let surface = vec4<u32>(bitcast<u32>(hit.t), roof.fid, bays_or_roof, normal);
    return BuildingTexels(surface, vec4<u32>(facade, roof.material));
}
