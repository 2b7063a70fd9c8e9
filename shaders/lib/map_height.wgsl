// The building map as a displacement map: one height a texel, that of the roof over the texel's reference point.

struct MapHeight {
    // Place in `map_quads` of the roof; its elevation, metres above the eye.
    roof_place: u32,
    height: f32,
}

// Below all ground: where no building stands.
const NO_HEIGHT: MapHeight = MapHeight(0u, -1.0e9);

fn covering(slot: TileRecord, code: u32) -> MapHeight {
    if !is_inside(code) { return NO_HEIGHT; }
    var place = roof_place(slot, index_of(code));
    if kind_of(code) == KIND_RUN { place = roof_place(slot, vertex_at(vertex_place(slot, index_of(code))).building); }
    return MapHeight(place, roof_at(place).roof_m - frame.eye_elevation);
}

// `local`: metres from the tile's south-west corner. Twin: BuildingMap::roof_at_reference.
fn map_height(slot: TileRecord, local: vec2<f32>, level: u32) -> MapHeight {
    let side = i32(1u << frame.tile_texels_log2);
    let texel = clamp(vec2<i32>(floor(local / (frame.texel_m * f32(1u << level)))), vec2<i32>(0), vec2<i32>(side - 1));
    let block = texel >> vec2<u32>(2u);
    let group = vec2<u32>(block) >> vec2<u32>(2u);
    let index = word_at(slot.word_base + group.y * (u32(side) / 16u) + group.x);
    if (index & (1u << child_number(block))) == 0u { return NO_HEIGHT; }
    let record = block_at(block, slot);
    if texel_kind(record.header, texel) == 0u { return NO_HEIGHT; }
    let code = texel_code(record, texel);
    if kind_of(code) != KIND_LIST { return covering(slot, code); }
    let list = slot.word_base + index_of(code);
    var best = NO_HEIGHT;
    var continued = false;
    for (var i = 0u; i < word_at(list); i += 1u) {
        let part = word_at(list + 1u + i);
        if !continued {
            let found = covering(slot, part);
            if found.height > best.height { best = found; }
        }
        continued = kind_of(part) == KIND_RUN && has_more(part);
    }
    return best;
}
