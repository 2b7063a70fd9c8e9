// The one traversal: view rays, shadow rays and picking. Twin: src/relief/march.rs.
//
// A ray walks the tree of highest roofs: what it stays above of a block is skipped in one read (maximum mipmaps: Tevs, Ihrke &
// Seidel 2008); at a texel the exact outline and roofs are met. On coarse levels a texel has no outline: it is a column of its roof.

struct Ray {
    // Eye-relative start, unit direction, 1 / direction.xy.
    start: vec3<f32>,
    direction: vec3<f32>,
    inverse: vec2<f32>,
}

struct Hit {
    // Metres along the ray, FAR without a hit.
    t: f32,
    // Place in `map_quads` of the building's roof.
    roof_place: u32,
    // Place in `map_quads` of the wall's first vertex; ROOF for a roof, SIDE for a column's side.
    edge: u32,
    // Where on the wall, 0 at that vertex and 1 at the next; 0 on a roof and on a column.
    along: f32,
    // Where the facade coordinates of the tile's vertices lie, 0 where it has none.
    word_base: u32,
    vertex_base: u32,
}

const ROOF: u32 = 0xffffffffu;
// One side of a column looks along x, one along y.
const SIDE_X: u32 = 0xfffffffeu;
const SIDE_Y: u32 = 0xfffffffdu;
const MISS: Hit = Hit(FAR, 0u, ROOF, 0.0, 0u, 0u);

fn make_ray(start: vec3<f32>, direction: vec3<f32>) -> Ray {
    let tiny = vec2<f32>(1.0e-9);
    let d = select(direction.xy, select(-tiny, tiny, direction.xy >= vec2<f32>(0.0)), abs(direction.xy) < tiny);
    let rise = select(direction.z, select(-tiny.x, tiny.x, direction.z >= 0.0), abs(direction.z) < tiny.x);
    return Ray(start, vec3<f32>(d, rise), 1.0 / d);
}

fn cross2(a: vec2<f32>, b: vec2<f32>) -> f32 { return a.x * b.y - a.y * b.x; }

// Rounding of a hit's place along the ray, metres.
fn slack(t: f32) -> f32 { return SLACK.x + SLACK.y * t; }

// First hit of the ray with the roofs and walls of one texel, between t0 and t1.
// `start` is the ray's start in the tile's local coordinates.
fn visit_cell(code: u32, reference: vec2<f32>, slot: TileRecord, ray: Ray, start: vec2<f32>, t0: f32, t1: f32) -> Hit {
    var best = MISS;
    let from_t = t0 - slack(t0);
    let to_t = t1 + slack(t1);
    let is_list = kind_of(code) == KIND_LIST;
    let list = slot.word_base + index_of(code);
    var count = 1u;
    if is_list { count = word_at(list); }
    // The code of this turn, codes read.
    var w = code;
    var i = 0u;
    // The record of this turn, edges left of the code's run, the vertex before.
    var index = 0u;
    var edges_left = 0u;
    var a = vec2<f32>(0.0);
    // The outline that the code belongs to.
    var continues = false;
    var roof = 0.0;
    var building = 0u;
    var t_roof = 0.0;
    var meets_roof = false;
    var inside = false;
    var to_p = vec2<f32>(0.0);
    // A turn reads one record: the first of a code, or the next vertex of its run.
    loop {
        let begins = edges_left == 0u;
        if begins && is_list { w = word_at(list + 1u + i); }
        let is_run = kind_of(w) == KIND_RUN;
        let first = select(roof_place(slot, index_of(w)), vertex_place(slot, index_of(w)), is_run);
        index = select(index + 1u, first, begins);
        let vertex = vertex_at(index);
        let b = vertex.position;
        if begins {
            i += 1u;
            if !continues {
                roof = vertex.roof_m - frame.eye_elevation;
                building = select(index_of(w), vertex.building, is_run);
                t_roof = (roof - ray.start.z) / ray.direction.z;
                meets_roof = ray.direction.z < 0.0 && t_roof >= from_t && t_roof <= to_t && t_roof < best.t;
                to_p = start + t_roof * ray.direction.xy - reference;
                inside = is_inside(w);
            }
            // A ray that stays above the roof can meet none of its walls.
            let dips = ray.start.z + min(from_t * ray.direction.z, to_t * ray.direction.z) <= roof;
            edges_left = select(0u, edges_of(w), is_run && dips);
            continues = edges_left > 0u && has_more(w);
        } else {
            let along = b - a;
            // The building is to the left of its outline: the wall faces right.
            let facing = cross2(ray.direction.xy, along);
            let t = cross2(a - start, along) / facing;
            let u = dot(start + t * ray.direction.xy - a, along) / dot(along, along);
            let low_enough = ray.start.z + t * ray.direction.z <= roof;
            if facing < 0.0 && t >= from_t && t <= to_t && t < best.t && low_enough && u >= -1.0e-5 && u <= 1.00001 {
                best = Hit(t, roof_place(slot, building), index - 1u, u, slot.word_base, vertex_place(slot, 0u));
            }
            // An edge between the point of the roof and the texel's reference, where it is known, changes sides.
            let to_a = a - reference;
            let to_b = b - reference;
            let apart = (cross2(to_p, to_a) >= 0.0) != (cross2(to_p, to_b) >= 0.0);
            let between = (cross2(to_a, along) >= 0.0) != (cross2(along, to_p - to_a) >= 0.0);
            inside = inside != (apart && between);
            edges_left -= 1u;
        }
        a = b;
        // Past the outline's last edge in this texel; `continues`: the list's next code has more of it.
        let past = edges_left == 0u && !(continues && i < count);
        if past && meets_roof && inside && t_roof < best.t { best = Hit(t_roof, roof_place(slot, building), ROOF, 0.0, select(0u, slot.word_base, slot.roof_quads == 2u), 0u); }
        continues = continues && !past;
        continuing { break if past && i >= count; }
    }
    return best;
}

// First hit of the ray with a column, the texel of a coarse level, between t0 and t1. `corner`, `size`: its plan.
fn visit_column(code: u32, corner: vec2<f32>, size: f32, slot: TileRecord, ray: Ray, start: vec2<f32>, t0: f32, t1: f32) -> Hit {
    let place = roof_place(slot, index_of(code));
    let roof = roof_at(place).roof_m - frame.eye_elevation;
    if !is_inside(code) { return MISS; }
    if ray.start.z + t0 * ray.direction.z <= roof {
        // The side that the ray came in by.
        let past = (start + t0 * ray.direction.xy - corner) * sign(ray.direction.xy);
        let deep = select(past + size, past, ray.direction.xy >= vec2<f32>(0.0));
        return Hit(t0, place, select(SIDE_Y, SIDE_X, deep.x < deep.y), 0.0, 0u, 0u);
    }
    let t_roof = (roof - ray.start.z) / ray.direction.z;
    if ray.direction.z < 0.0 && t_roof <= t1 + slack(t1) { return Hit(t_roof, place, ROOF, 0.0, 0u, 0u); }
    return MISS;
}

// Twin: Pyramid::top_level.
fn top_node_level() -> u32 { return max(frame.tile_texels_log2 / 2u, 1u); }

fn nearer(t: vec2<f32>, end: f32) -> f32 { return min(min(t.x, t.y), end); }

// Where a ray is in one tile, and the texel to look into when there is one.
struct Walk {
    // The ray's start in the tile's local coordinates; a step below the lowest ground, metres above the ray's start.
    start: vec2<f32>,
    floor_z: f32,
    // Side of a texel, metres.
    texel_m: f32,
    // Metres along the ray: here, and at the end of the walk.
    t: f32,
    end: f32,
    // The node that the ray is in; metres that a byte of it counts.
    level: u32,
    node: vec2<i32>,
    step_m: f32,
    // On level 0 the node is a block: its record, the byte of its roofs.
    block: BlockRecord,
    block_byte: u32,
    // The texel that the ray is in, or the block under one roof, its size in texels, its code, and where the ray leaves it; found is
    // false past the tile.
    found: bool,
    texel: vec2<i32>,
    texels: f32,
    code: u32,
    t_past: f32,
}

// The beginning of the ray's way through a tile from t0 to t1.
fn enter_tile(slot: TileRecord, corner: vec2<f32>, texel_m: f32, ray: Ray, t0: f32, t1: f32) -> Walk {
    let start = ray.start.xy - corner;
    // Begin with nodes about as large as the way to go: a short way need not come down from the tile's top.
    let texels = length(ray.direction.xy) * (t1 - t0) / texel_m;
    let level = u32(clamp(ceil(0.5 * log2(max(texels, 1.0))) - 1.0, 1.0, f32(top_node_level())));
    let place = (start + t0 * ray.direction.xy) / texel_m;
    let texel = clamp(vec2<i32>(floor(place)), vec2<i32>(0), vec2<i32>((1 << frame.tile_texels_log2) - 1));
    let step_m = step_of(slot);
    let floor_z = slot.min_height - step_m - frame.eye_elevation - ray.start.z;
    let node = texel >> vec2<u32>(2u * level + 2u);
    return Walk(start, floor_z, texel_m, t0, t1, level, node, step_m, BlockRecord(0u, 0u, 0u), 0u, false, vec2<i32>(0), 1.0, 0u, t0);
}

// On to the next texel that the ray dips into. One read tells the bounds of a node's 4 x 4 children; the ray meets at most
// seven of them, in order, and goes down into the first that it does not stay above.
fn next_texel(walk: ptr<function, Walk>, slot: TileRecord, ray: Ray) {
    let forward = ray.direction.xy >= vec2<f32>(0.0);
    let step = select(vec2<i32>(-1), vec2<i32>(1), forward);
    let lead = select(vec2<f32>(0.0), vec2<f32>(1.0), forward);
    let falls = ray.direction.z < 0.0;
    let start = (*walk).start;
    let t1 = (*walk).end;
    let step_m = (*walk).step_m;
    var t = (*walk).t;
    var level = (*walk).level;
    var node = (*walk).node;
    var block = (*walk).block;
    var block_byte = (*walk).block_byte;
    var child = vec2<i32>(0);
    var code = 0u;
    var t_past = t;
    var found = false;
    var steps = 0u;
    loop {
        let size = (*walk).texel_m * f32(1u << (2u * level));
        let is_block = level == 0u;
        // The texels of a block count as high as the block.
        var rows = vec4<u32>(0u);
        if !is_block { rows = node_at(node, level, slot); }
        let floor_z = (*walk).floor_z + slack(t);
        child = clamp(vec2<i32>(floor((start + t * ray.direction.xy) / size)), 4 * node, 4 * node + 3);
        var t_border = ((vec2<f32>(child) + lead) * size - start) * ray.inverse;
        let t_step = size * abs(ray.inverse);
        var dips = false;
        var left = false;
        var byte = 0u;
        loop {
            t_past = nearer(t_border, t1);
            let lowest = select(t, t_past, falls) * ray.direction.z;
            byte = select(child_byte(rows, child), select(0u, block_byte, texel_kind(block.header, child) != 0u), is_block);
            dips = byte != 0u && t_past > t && lowest <= floor_z + f32(byte) * step_m;
            if !dips {
                t = max(t, t_past);
                let along_x = t_border.x <= t_border.y;
                child += select(vec2<i32>(0, step.y), vec2<i32>(step.x, 0), along_x);
                t_border += select(vec2<f32>(0.0, t_step.y), vec2<f32>(t_step.x, 0.0), along_x);
                left = any((child >> vec2<u32>(2u)) != node);
            }
            continuing { break if dips || left || t >= t1; }
        }
        found = dips && is_block;
        // A block: one roof over all of it is found, a record is gone into.
        if dips && level == 1u {
            block = block_at(child, slot);
            found = block.header == UNIFORM;
            block_byte = byte;
            code = block.main_code;
        }
        let children = max((1 << frame.tile_texels_log2) >> (2u * level), 1);
        let gone = !dips && (t >= t1 || any(child < vec2<i32>(0)) || any(child >= vec2<i32>(children)));
        // Down into the child; or over to the next node, and up when that has another parent, or out of a block.
        let next = child >> vec2<u32>(2u);
        let other_parent = level < top_node_level() && any((next >> vec2<u32>(2u)) != (node >> vec2<u32>(2u)));
        let rises = is_block || other_parent;
        if !found {
            node = select(select(next, next >> vec2<u32>(2u), rises), child, dips);
            level = select(select(level, level + 1u, rises), max(level, 1u) - 1u, dips);
        }
        steps += 1u;
        continuing { break if found || gone || steps >= MAX_STEPS; }
    }
    if found && level == 0u { code = texel_code(block, child); }
    (*walk).t = t;
    (*walk).level = level;
    (*walk).node = node;
    (*walk).block = block;
    (*walk).block_byte = block_byte;
    (*walk).found = found;
    (*walk).texel = child;
    (*walk).texels = select(4.0, 1.0, level == 0u);
    (*walk).code = code;
    (*walk).t_past = t_past;
}

// First hit within one tile of a level between t0 and t1. Stepping and visiting are loops of their own: lanes that have found a
// texel wait for the others, so that the costly visit is made together (Aila & Laine 2009, "while-while"). All loops here test at
// their end: a software device runs a body that it tests at the top once more than needed.
fn walk_tile(slot: TileRecord, corner: vec2<f32>, tile_level: u32, ray: Ray, t0: f32, t1: f32) -> Hit {
    var walk = enter_tile(slot, corner, frame.texel_m * f32(1u << tile_level), ray, t0, t1);
    var hit = MISS;
    var visits = 0u;
    loop {
        next_texel(&walk, slot, ray);
        if walk.found {
            let texel = vec2<f32>(walk.texel);
            if tile_level == 0u {
                let reference = (texel + REFERENCE) * walk.texel_m;
                hit = visit_cell(walk.code, reference, slot, ray, walk.start, walk.t, walk.t_past);
            } else {
                let size = walk.texels * walk.texel_m;
                hit = visit_column(walk.code, texel * size, size, slot, ray, walk.start, walk.t, walk.t_past);
            }
            walk.t = walk.t_past;
        }
        visits += 1u;
        continuing { break if hit.t < FAR || !walk.found || visits >= MAX_STEPS; }
    }
    return hit;
}

// First hit with any building of the city between t0 and t1, tile after tile.
fn walk_city(ray: Ray, t0: f32, t1: f32) -> Hit {
    let forward = ray.direction.xy >= vec2<f32>(0.0);
    let lead = select(vec2<f32>(0.0), vec2<f32>(1.0), forward);
    // Only the way through the city's volume: over its tiles and below its highest roof.
    let low = tile_corner(vec2<i32>(0)) - ray.start.xy;
    let high = tile_corner(frame.grid) - ray.start.xy;
    let t_in = select(high, low, forward) * ray.inverse;
    let t_past = select(low, high, forward) * ray.inverse;
    let t_roofs = (frame.max_roof - ray.start.z) / ray.direction.z;
    var t = max(t0, max(t_in.x, t_in.y));
    var end = min(t1, min(t_past.x, t_past.y));
    if ray.direction.z > 0.0 { end = min(end, t_roofs); }
    if ray.direction.z < 0.0 { t = max(t, t_roofs); }
    var hit = MISS;
    if t >= end { return hit; }
    let place = frame.eye_in_tile + ray.start.xy + t * ray.direction.xy;
    var tile = frame.eye_tile + vec2<i32>(floor(place / frame.tile_m));
    var tiles = 0u;
    loop {
        let entry = map_entry(tile);
        let tile_m = level_tile_m(entry.level);
        let first = tile_over(tile, entry.level);
        let corner = tile_corner(first);
        let t_border = (corner + lead * tile_m - ray.start.xy) * ray.inverse;
        let t_out = nearer(t_border, end);
        if entry.slot >= 0 {
            let slot = slot_at(entry.slot);
            // Of the way through the tile only what lies between its lowest ground and its highest roof: a ray that comes in
            // under the ground, past the city's edge, meets nothing.
            let t_low = (slot.min_height - frame.eye_elevation - ray.start.z) / ray.direction.z;
            let t_high = (slot.max_height - frame.eye_elevation - ray.start.z) / ray.direction.z;
            let t_first = min(t_low, t_high);
            let t_last = max(t_low, t_high);
            let from_t = max(t, t_first - slack(abs(t_first)));
            let to_t = min(t_out, t_last + slack(abs(t_last)));
            if from_t <= to_t {
                let met = walk_tile(slot, corner, entry.level, ray, from_t, to_t);
                if met.t <= end { hit = met; }
            }
        }
        t = max(t, t_out);
        tile = tile_past(first, entry.level, ray, t, t_border.x <= t_border.y);
        let gone = select((tile < vec2<i32>(0)), (tile >= frame.grid), forward);
        tiles += 1u;
        continuing { break if hit.t < FAR || t >= end || any(gone) || tiles >= MAX_STEPS; }
    }
    return hit;
}

// The tile of the grid that a ray comes into as it leaves the tile of a level over `first` at t.
fn tile_past(first: vec2<i32>, level: u32, ray: Ray, t: f32, along_x: bool) -> vec2<i32> {
    let last = first + (1 << level) - 1;
    let position = frame.eye_in_tile + ray.start.xy + t * ray.direction.xy;
    let beside = clamp(frame.eye_tile + vec2<i32>(floor(position / frame.tile_m)), first, last);
    let past = select(first - 1, last + 1, ray.direction.xy >= vec2<f32>(0.0));
    return select(vec2<i32>(beside.x, past.y), vec2<i32>(past.x, beside.y), along_x);
}

// Outward unit normal of what was hit.
fn hit_normal(hit: Hit, ray: Ray) -> vec3<f32> {
    if hit.edge == ROOF { return vec3<f32>(0.0, 0.0, 1.0); }
    if hit.edge == SIDE_X { return vec3<f32>(-sign(ray.direction.x), 0.0, 0.0); }
    if hit.edge == SIDE_Y { return vec3<f32>(0.0, -sign(ray.direction.y), 0.0); }
    let along = vertex_at(hit.edge + 1u).position - vertex_at(hit.edge).position;
    return normalize(vec3<f32>(along.y, -along.x, 0.0));
}

// Where on a facade a hit lies.
struct FacadePosition {
    // Bays along the building's outline: the facade coordinate; 0 on a roof and on a column.
    bays: f32,
    // Bays a metre.
    bays_per_m: f32,
}

fn facade_position(hit: Hit) -> FacadePosition {
    if hit.edge >= SIDE_Y { return FacadePosition(0.0, 0.0); }
    let vertex = hit.edge - hit.vertex_base;
    let first = bitcast<f32>(word_at(hit.word_base - 1u - vertex));
    let bays = bitcast<f32>(word_at(hit.word_base - 2u - vertex)) - first;
    let edge_m = distance(vertex_at(hit.edge).position, vertex_at(hit.edge + 1u).position);
    return FacadePosition(first + hit.along * bays, bays / edge_m);
}
