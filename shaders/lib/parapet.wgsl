// The parapet of a flat roof: a coping along the outline and the shade in its corner, as far as the outline's edges tell.

// Width of the coping, and how far the corner is shaded, metres.
const COPING_M: f32 = 0.3;
const CORNER_M: f32 = 1.0;
const COPING: vec3<f32> = vec3<f32>(0.46, 0.45, 0.42);
// Part of the light that the corner keeps.
const CORNER: f32 = 0.62;
// Size of a pixel, metres, from which on no parapet is told from the roof.
const NO_PARAPET_M: f32 = 0.4;

fn distance_to(at: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> f32 {
    let along = b - a;
    return distance(at, a + clamp(dot(at - a, along) / max(dot(along, along), 1.0e-6), 0.0, 1.0) * along);
}

// Distance from a run's edges, where it is of the building.
fn run_distance(slot: TileRecord, code: u32, fid: u32, at: vec2<f32>) -> f32 {
    if kind_of(code) != KIND_RUN { return CORNER_M; }
    let first = vertex_place(slot, index_of(code));
    var a = vertex_at(first);
    if roof_at(roof_place(slot, a.building)).fid != fid { return CORNER_M; }
    var least = CORNER_M;
    for (var e = 0u; e < edges_of(code); e += 1u) {
        let b = vertex_at(first + e + 1u);
        least = min(least, distance_to(at, a.position, b.position));
        a = b;
    }
    return least;
}

// Distance from the edges of a building that pass a texel, at most CORNER_M.
fn texel_distance(slot: TileRecord, texel: vec2<i32>, fid: u32, at: vec2<f32>) -> f32 {
    let block = texel >> vec2<u32>(2u);
    let group = vec2<u32>(block) >> vec2<u32>(2u);
    let index = word_at(slot.word_base + group.y * ((1u << frame.tile_texels_log2) / 16u) + group.x);
    if (index & (1u << child_number(block))) == 0u { return CORNER_M; }
    let record = block_at(block, slot);
    if record.header == UNIFORM || texel_kind(record.header, texel) == 0u { return CORNER_M; }
    let code = texel_code(record, texel);
    if kind_of(code) != KIND_LIST { return run_distance(slot, code, fid, at); }
    let list = slot.word_base + index_of(code);
    var least = CORNER_M;
    for (var i = 0u; i < word_at(list); i += 1u) { least = min(least, run_distance(slot, word_at(list + 1u + i), fid, at)); }
    return least;
}

// Distance in plan of a place on a roof, metres from the eye, from the outline, at most CORNER_M.
fn outline_distance(at: vec2<f32>, fid: u32) -> f32 {
    let in_grid = frame.eye_in_tile + at;
    let tile = frame.eye_tile + vec2<i32>(floor(in_grid / frame.tile_m));
    let entry = map_entry(tile);
    if entry.slot < 0 || entry.level > 0u { return CORNER_M; }
    let slot = slot_at(entry.slot);
    let local = at - tile_corner(tile);
    let last = i32(1u << frame.tile_texels_log2) - 1;
    let from_texel = clamp(vec2<i32>(floor((local - CORNER_M) / frame.texel_m)), vec2<i32>(0), vec2<i32>(last));
    let to_texel = clamp(vec2<i32>(floor((local + CORNER_M) / frame.texel_m)), vec2<i32>(0), vec2<i32>(last));
    // Finer maps than a metre have fewer of their texels looked at than there are.
    let end = min(to_texel, from_texel + 4);
    var least = CORNER_M;
    for (var y = from_texel.y; y <= end.y; y += 1) {
        for (var x = from_texel.x; x <= end.x; x += 1) { least = min(least, texel_distance(slot, vec2<i32>(x, y), fid, local)); }
    }
    return least;
}

// A flat roof's material with its parapet; `at`: metres from the eye.
fn with_parapet(roof: Material, fid: u32, at: vec2<f32>, pixel_m: f32) -> Material {
    if pixel_m >= NO_PARAPET_M { return roof; }
    let edge_m = outline_distance(at, fid);
    let coping = 1.0 - smoothstep(COPING_M - pixel_m, COPING_M + pixel_m, edge_m);
    let shade = mix(CORNER, 1.0, smoothstep(COPING_M, CORNER_M, edge_m));
    let told = 1.0 - smoothstep(0.5 * NO_PARAPET_M, NO_PARAPET_M, pixel_m);
    var material = roof;
    material.albedo = mix(roof.albedo, mix(roof.albedo * shade, COPING, coping), told);
    material.normal = normalize(mix(roof.normal, vec3<f32>(0.0, 0.0, 1.0), coping * told));
    return material;
}
