// The building map of all resident tiles. Twin: src/buildings/map.rs, which explains the words.

struct TileSlot {
    // Column and row in the grid.
    tile: vec2<i32>,
    // Where the tile's records begin in the shared buffers.
    vertex_base: u32,
    piece_base: u32,
    roof_base: u32,
    padding: u32,
    // Lowest ground and highest roof, metres above the vertical datum: the volume that overflow faces span.
    low: f32,
    high: f32,
}

struct OutlineVertex {
    position: vec2<f32>,
    along_m: f32,
    building: u32,
}

struct RoofRecord {
    roof_m: f32,
    base_m: f32,
    fid: u32,
    padding: u32,
}

// Per grid tile: slot of its building map, layer of its photo; -1 = none.
@group(1) @binding(0) var tile_table: texture_2d<i32>;
@group(1) @binding(1) var<storage, read> slots: array<TileSlot>;
@group(1) @binding(2) var cells: texture_2d_array<u32>;
// Level by level (0 = blocks of 2 x 2 texels): the highest roofs of a block's four quarters, rows from the south, metres
// above the tile's `low`.
@group(1) @binding(3) var pyramid: texture_2d_array<f32>;
@group(1) @binding(4) var<storage, read> vertices: array<OutlineVertex>;
@group(1) @binding(5) var<storage, read> pieces: array<u32>;
@group(1) @binding(6) var<storage, read> roofs: array<RoofRecord>;

// Highest roofs of the quarters of a block of 2^level texels, metres above the tile's `low`.
fn highest_quarters(block: vec2<i32>, level: u32, slot_index: i32) -> vec4<f32> {
    return textureLoad(pyramid, block, slot_index, i32(level) - 1);
}

const KIND_FULL: u32 = 1u;
const KIND_RUN: u32 = 2u;
const KIND_LIST: u32 = 3u;
const REFERENCE: vec2<f32> = vec2<f32>(0.4387, 0.5719);

fn kind_of(word: u32) -> u32 { return word >> 30u; }
fn index_of(word: u32) -> u32 { return word & 0xffffffu; }
fn is_inside(word: u32) -> bool { return (word & 0x20000000u) != 0u; }
fn has_more(word: u32) -> bool { return (word & 0x10000000u) != 0u; }
fn edges_of(word: u32) -> u32 { return ((word >> 24u) & 15u) + 1u; }
