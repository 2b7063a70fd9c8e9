// The building map of all resident tiles. Host: src/buildings/map.rs, which explains the codes.

// A record is read as one vector of 16 bytes: a software device reads each member of a structure on its own.
struct TileRecord {
    // The tile's first outline vertex in `vertices`; its roofs stand before it, the first the nearest.
    vertex_base: u32,
    // The tile's first code in `lists`.
    list_base: u32,
    // Lowest ground and highest roof, metres above the vertical datum.
    min_height: f32,
    max_height: f32,
}

struct VertexRecord {
    // Metres from the tile's south-west corner; 0 in the record of a roof.
    position: vec2<f32>,
    // Elevation of the building's roof, its id.
    roof_m: f32,
    fid: u32,
}

// Per grid tile: slot of its building map, layer of its orthophoto; -1 = none.
@group(1) @binding(0) var tile_table: texture_2d<i32>;
@group(1) @binding(1) var<storage, read> slots: array<vec4<u32>>;
@group(1) @binding(2) var cells: texture_2d_array<u32>;
// Nodes of 4 x 4 children, a byte a child. Twin: src/buildings/pyramid.rs, which tells the layout.
@group(1) @binding(3) var pyramid: texture_2d_array<u32>;
// Edge e of an outline runs from vertex e to e + 1.
@group(1) @binding(4) var<storage, read> vertices: array<vec4<u32>>;
@group(1) @binding(5) var<storage, read> lists: array<u32>;
// Metres along its outline, for every vertex.
@group(1) @binding(6) var<storage, read> along_outline: array<f32>;

fn slot_at(index: i32) -> TileRecord {
    let record = slots[index];
    return TileRecord(record.x, record.y, bitcast<f32>(record.z), bitcast<f32>(record.w));
}

fn vertex_at(index: u32) -> VertexRecord {
    let record = vertices[index];
    return VertexRecord(bitcast<vec2<f32>>(record.xy), bitcast<f32>(record.z), record.w);
}

// A roof's record in `vertices`.
fn roof_index(slot: TileRecord, building: u32) -> u32 { return slot.vertex_base - 1u - building; }

// Four rows of four bytes, from the south-west.
fn node_at(node: vec2<i32>, level: u32, slot_index: i32) -> vec4<u32> {
    let width = i32(frame.pyramid_width);
    // width / 4 + width / 16 + .. of the levels between lie to the west.
    let west = (width - (width >> (2u * max(level, 1u) - 2u))) / 3;
    let corner = select(vec2<i32>(west, width), vec2<i32>(0), level == 0u);
    return textureLoad(pyramid, corner + node, slot_index, 0);
}

// Bound on the roofs of a node's child, in metres above the tile's lowest ground: (byte - 1) of these steps.
fn step_of(slot: TileRecord) -> f32 { return max((slot.max_height - slot.min_height) / PYRAMID_STEPS, 0.0); }

fn child_byte(rows: vec4<u32>, child: vec2<i32>) -> u32 {
    let local = vec2<u32>(child) & vec2<u32>(3u);
    let south = select(rows.x, rows.y, local.y == 1u);
    let north = select(rows.z, rows.w, local.y == 3u);
    return (select(south, north, local.y >= 2u) >> (8u * local.x)) & 255u;
}

fn kind_of(code: u32) -> u32 { return code >> KIND_SHIFT; }
fn index_of(code: u32) -> u32 { return code & INDEX_MASK; }
fn is_inside(code: u32) -> bool { return (code & INSIDE_BIT) != 0u; }
fn has_more(code: u32) -> bool { return (code & MORE_BIT) != 0u; }
fn edges_of(code: u32) -> u32 { return ((code >> EDGES_SHIFT) & EDGES_MASK) + 1u; }
