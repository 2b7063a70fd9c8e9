// Which tiles are resident: for every tile of the grid, the tile that stands for it in each layer, itself or a coarser one over it.
// Host: src/scene/tile_table.rs.

// Building map, imagery, terrain: the slot and one more, 0 = none, and from TABLE_LEVEL_SHIFT on the level. Then where the record of
// the building map lies.
@group(1) @binding(0) var tile_table: texture_2d<u32>;

struct TableEntry {
    // -1 = nothing there.
    slot: i32,
    level: u32,
}

fn table_entry(code: u32) -> TableEntry {
    return TableEntry(i32(code & ((1u << TABLE_LEVEL_SHIFT) - 1u)) - 1, code >> TABLE_LEVEL_SHIFT);
}

fn is_in_grid(tile: vec2<i32>) -> bool { return all(tile >= vec2<i32>(0)) && all(tile < frame.grid); }

// The tile of a level over a tile of the grid, by its south-western one.
fn tile_over(tile: vec2<i32>, level: u32) -> vec2<i32> { return (tile >> vec2<u32>(level)) << vec2<u32>(level); }

// Side of a tile of a level, metres.
fn level_tile_m(level: u32) -> f32 { return frame.tile_m * f32(1u << level); }

// The building map over a tile of the grid; its slot is the place of its record in `map_quads`.
fn map_entry(tile: vec2<i32>) -> TableEntry {
    if !is_in_grid(tile) || (frame.hidden & HIDES_BUILDINGS) != 0u { return TableEntry(-1, 0u); }
    let codes = textureLoad(tile_table, tile, 0);
    let entry = table_entry(codes.x);
    return TableEntry(select(-1, i32(codes.w), entry.slot >= 0), entry.level);
}

// The imagery over a tile of the grid; its slot is a layer.
fn imagery_entry(tile: vec2<i32>) -> TableEntry {
    if !is_in_grid(tile) || (frame.hidden & HIDES_IMAGERY) != 0u { return TableEntry(-1, 0u); }
    return table_entry(textureLoad(tile_table, tile, 0).y);
}

// The terrain over a tile of the grid; its slot is a layer.
fn terrain_entry(tile: vec2<i32>) -> TableEntry {
    if !is_in_grid(tile) { return TableEntry(-1, 0u); }
    return table_entry(textureLoad(tile_table, tile, 0).z);
}
