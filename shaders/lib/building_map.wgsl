// The building maps of all resident tiles. Host: src/buildings/map.rs, which tells how words lie, and src/scene/map_pool.rs.

struct TileRecord {
    // The first node of the tile's pyramid in `map_quads`: its outline vertices stand behind the nodes, its roofs before them,
    // `roof_quads` records each, the first the nearest; before those this record.
    quad_base: u32,
    // The tile's first word in `map_words`: the facade coordinates of its vertices stand before it, the first vertex's the nearest.
    word_base: u32,
    // Lowest ground and highest roof, metres above the vertical datum.
    min_height: f32,
    max_height: f32,
    // The record of its first block in `map_quads`.
    block_base: u32,
    // Records that a roof takes: without outlines, on coarse levels, one.
    roof_quads: u32,
    padding_a: u32,
    padding_b: u32,
}

struct VertexRecord {
    // Metres from the tile's south-west corner.
    position: vec2<f32>,
    // Elevation of the building's roof: it stands where a roof's record has it.
    roof_m: f32,
    // Index of the building in its tile.
    building: u32,
}

struct RoofRecord {
    // Lowest ground at the building's outline, metres above the vertical datum.
    base_m: f32,
    // What the building is made of (`facade.wgsl`).
    material: u32,
    // Elevation of the roof, the building's id.
    roof_m: f32,
    fid: u32,
}

// What stands behind a roof's record on the finest level.
struct RoofOutline {
    // Place of the first vertex of its outline, counted from the roof's; edges, 0 where they are too many for a pitched roof
    // (`pitched_roof.wgsl`); a bit for each of them that is none, but leads from one ring to the next.
    vertex: u32,
    edges: u32,
    gaps: u32,
    padding: u32,
}

// Counted row by row, POOL_WORDS and POOL_QUADS a row. Textures, because a software device gathers from those for all lanes at once.
@group(1) @binding(1) var map_words: texture_2d<u32>;
@group(1) @binding(2) var map_quads: texture_2d<u32>;

fn word_at(place: u32) -> u32 {
    return textureLoad(map_words, vec2<u32>(place % POOL_WORDS, place / POOL_WORDS), 0).x;
}

fn quad_at(place: u32) -> vec4<u32> {
    return textureLoad(map_quads, vec2<u32>(place % POOL_QUADS, place / POOL_QUADS), 0);
}

fn slot_at(place: i32) -> TileRecord {
    let record = quad_at(u32(place));
    let more = quad_at(u32(place) + 1u);
    return TileRecord(record.x, record.y, bitcast<f32>(record.z), bitcast<f32>(record.w), more.x, more.y, 0u, 0u);
}

// A place in `map_quads`: of an outline vertex (edge e runs from vertex e to e + 1), of a roof.
fn vertex_place(slot: TileRecord, vertex: u32) -> u32 { return slot.quad_base + frame.pyramid_nodes + vertex; }
fn roof_place(slot: TileRecord, building: u32) -> u32 { return slot.quad_base - slot.roof_quads * (building + 1u); }

// What stands at such places. A roof read as a vertex tells its elevation.
fn vertex_at(place: u32) -> VertexRecord {
    let record = quad_at(place);
    return VertexRecord(bitcast<vec2<f32>>(record.xy), bitcast<f32>(record.z), record.w);
}

fn roof_at(place: u32) -> RoofRecord {
    let record = quad_at(place);
    return RoofRecord(bitcast<f32>(record.x), record.y, bitcast<f32>(record.z), record.w);
}

fn roof_outline(place: u32) -> RoofOutline {
    let record = quad_at(place + 1u);
    return RoofOutline(record.x, record.y, record.z, record.w);
}

// Four rows of four bytes, from the south-west. Twin: Pyramid::first_node and place.
fn node_at(node: vec2<i32>, level: u32, slot: TileRecord) -> vec4<u32> {
    let blocks = (1u << frame.tile_texels_log2) / 4u;
    let below = blocks >> (2u * level - 2u);
    let across = max(below / 4u, 1u);
    let first = (blocks * blocks - below * below) / 15u;
    return quad_at(slot.quad_base + first + u32(node.y) * across + u32(node.x));
}

// Bound on the roofs of a node's child, in metres above the tile's lowest ground: (byte - 1) of these steps.
fn step_of(slot: TileRecord) -> f32 { return max((slot.max_height - slot.min_height) / PYRAMID_STEPS, 0.0); }

fn child_byte(rows: vec4<u32>, child: vec2<i32>) -> u32 {
    let local = vec2<u32>(child) & vec2<u32>(3u);
    let south = select(rows.x, rows.y, local.y == 1u);
    let north = select(rows.z, rows.w, local.y == 3u);
    return (select(south, north, local.y >= 2u) >> (8u * local.x)) & 255u;
}

// Number of a child among its 4 x 4.
fn child_number(child: vec2<i32>) -> u32 { return (u32(child.y) & 3u) * 4u + (u32(child.x) & 3u); }

// An occupied block of 4 x 4 texels.
struct BlockRecord {
    // Two bits a texel: 0, TEXEL_MAIN or TEXEL_OWN.
    header: u32,
    // The code of the texels with TEXEL_MAIN.
    main_code: u32,
    // Place in `map_words` of the codes of those with TEXEL_OWN.
    own_place: u32,
}

fn block_at(block: vec2<i32>, slot: TileRecord) -> BlockRecord {
    let groups = (1u << frame.tile_texels_log2) / 16u;
    let group = vec2<u32>(block) >> vec2<u32>(2u);
    let index = word_at(slot.word_base + group.y * groups + group.x);
    let before = countOneBits(index & ((1u << child_number(block)) - 1u));
    let record = quad_at(slot.block_base + (index >> 16u) + before);
    return BlockRecord(record.x, record.y, slot.word_base + record.z);
}

// The header of a block that lies under one roof.
const UNIFORM: u32 = 0x55555555u;

fn texel_kind(header: u32, texel: vec2<i32>) -> u32 { return (header >> (2u * child_number(texel))) & 3u; }

// The code of a texel that holds a building.
fn texel_code(block: BlockRecord, texel: vec2<i32>) -> u32 {
    if texel_kind(block.header, texel) == TEXEL_MAIN { return block.main_code; }
    let own_before = countOneBits(block.header & 0xaaaaaaaau & ((1u << (2u * child_number(texel))) - 1u));
    return word_at(block.own_place + own_before);
}

fn kind_of(code: u32) -> u32 { return code >> KIND_SHIFT; }
fn index_of(code: u32) -> u32 { return code & INDEX_MASK; }
// Of a run: the reference point lies inside. Of a roof: it shows.
fn is_inside(code: u32) -> bool { return (code & INSIDE_BIT) != 0u; }
fn has_more(code: u32) -> bool { return (code & MORE_BIT) != 0u; }
fn edges_of(code: u32) -> u32 { return ((code >> EDGES_SHIFT) & EDGES_MASK) + 1u; }
