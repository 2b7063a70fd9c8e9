// The one traversal: view rays, shadow rays and picking. Twin: src/relief/march.rs.
//
// A ray walks the tree of highest roofs (`pyramid`): what it stays above of a block is skipped in one read
// (maximum mipmaps: Tevs, Ihrke & Seidel 2008); at a texel the exact outline and roofs are met.

struct Ray {
    // Eye-relative start, unit direction, 1 / direction.xy.
    start: vec3<f32>,
    direction: vec3<f32>,
    inverse: vec2<f32>,
}

struct Hit {
    // Metres along the ray, FAR without a hit.
    t: f32,
    // Id of the building.
    fid: u32,
    // Index into `vertices` of the wall's first vertex, ROOF for a roof.
    edge: u32,
    // Metres along the wall from that corner, 0 on a roof.
    along_wall_m: f32,
}

const ROOF: u32 = 0xffffffffu;
const MISS: Hit = Hit(FAR, 0u, 0u, 0.0);

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
fn visit_cell(code: u32, cell: vec2<i32>, slot: TileRecord, ray: Ray, start: vec2<f32>, t0: f32, t1: f32) -> Hit {
    var best = MISS;
    let from_t = t0 - slack(t0);
    let to_t = t1 + slack(t1);
    let reference = (vec2<f32>(cell) + REFERENCE) * frame.texel_m;
    let is_list = kind_of(code) == KIND_LIST;
    let list = slot.list_base + index_of(code);
    var count = 1u;
    if is_list { count = lists[list]; }
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
    var fid = 0u;
    var t_roof = 0.0;
    var meets_roof = false;
    var inside = false;
    var to_p = vec2<f32>(0.0);
    // A turn reads one record: the first of a code, or the next vertex of its run.
    loop {
        let begins = edges_left == 0u;
        if begins && is_list { w = lists[list + 1u + i]; }
        let is_run = kind_of(w) == KIND_RUN;
        let first = select(roof_index(slot, index_of(w)), slot.vertex_base + index_of(w), is_run);
        index = select(index + 1u, first, begins);
        let vertex = vertex_at(index);
        let b = vertex.position;
        if begins {
            i += 1u;
            if !continues {
                roof = vertex.roof_m - frame.eye_elevation;
                fid = vertex.fid;
                t_roof = (roof - ray.start.z) / ray.direction.z;
                meets_roof = ray.direction.z < 0.0 && t_roof >= from_t && t_roof <= to_t && t_roof < best.t;
                to_p = start + t_roof * ray.direction.xy - reference;
                inside = !is_run || is_inside(w);
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
                best = Hit(t, fid, index - 1u, u * length(along));
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
        if past && meets_roof && inside && t_roof < best.t { best = Hit(t_roof, fid, ROOF, 0.0); }
        continues = continues && !past;
        continuing { break if past && i >= count; }
    }
    return best;
}

// Twin: Pyramid::top_level.
fn top_node_level() -> u32 { return frame.tile_texels_log2 / 2u; }

fn nearer(t: vec2<f32>, end: f32) -> f32 { return min(min(t.x, t.y), end); }

// Where a ray is in one tile, and the texel to look into when there is one.
struct Walk {
    slot_index: i32,
    // The ray's start in the tile's local coordinates; a step below the lowest ground, metres above the ray's start.
    start: vec2<f32>,
    floor_z: f32,
    // Metres along the ray: here, and at the end of the walk.
    t: f32,
    end: f32,
    // The node that the ray is in; metres that a byte of it counts.
    level: u32,
    node: vec2<i32>,
    step_m: f32,
    // The texel that the ray is in and where it leaves it; found is false past the tile.
    found: bool,
    texel: vec2<i32>,
    t_past: f32,
}

// The beginning of the ray's way through a tile from t0 to t1.
fn enter_tile(slot_index: i32, slot: TileRecord, corner: vec2<f32>, ray: Ray, t0: f32, t1: f32) -> Walk {
    let start = ray.start.xy - corner;
    // Begin with nodes about as large as the way to go: a short way need not come down from the tile's top.
    let texels = length(ray.direction.xy) * (t1 - t0) / frame.texel_m;
    let level = u32(clamp(ceil(0.5 * log2(max(texels, 1.0))) - 1.0, 0.0, f32(top_node_level())));
    let place = (start + t0 * ray.direction.xy) / frame.texel_m;
    let texel = clamp(vec2<i32>(floor(place)), vec2<i32>(0), vec2<i32>((1 << frame.tile_texels_log2) - 1));
    let step_m = step_of(slot);
    let floor_z = slot.min_height - step_m - frame.eye_elevation - ray.start.z;
    return Walk(slot_index, start, floor_z, t0, t1, level, texel >> vec2<u32>(2u * level + 2u), step_m, false, vec2<i32>(0), t0);
}

// On to the next texel that the ray dips into. One read tells the bounds of a node's 4 x 4 children; the ray meets at most
// seven of them, in order, and goes down into the first that it does not stay above.
fn next_texel(walk: ptr<function, Walk>, ray: Ray) {
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
    var child = vec2<i32>(0);
    var t_past = t;
    var found = false;
    var steps = 0u;
    loop {
        let size = frame.texel_m * f32(1u << (2u * level));
        let rows = node_at(node, level, (*walk).slot_index);
        let floor_z = (*walk).floor_z + slack(t);
        child = clamp(vec2<i32>(floor((start + t * ray.direction.xy) / size)), 4 * node, 4 * node + 3);
        var t_border = ((vec2<f32>(child) + lead) * size - start) * ray.inverse;
        let t_step = size * abs(ray.inverse);
        var dips = false;
        var left = false;
        loop {
            t_past = nearer(t_border, t1);
            let lowest = select(t, t_past, falls) * ray.direction.z;
            let byte = child_byte(rows, child);
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
        found = dips && level == 0u;
        let tiles_children = (1 << frame.tile_texels_log2) >> (2u * level);
        let gone = !dips && (t >= t1 || any(child < vec2<i32>(0)) || any(child >= vec2<i32>(tiles_children)));
        // Down into the child; or over to the next node, and up when that has another parent.
        let next = child >> vec2<u32>(2u);
        let rises = level < top_node_level() && any((next >> vec2<u32>(2u)) != (node >> vec2<u32>(2u)));
        if !found {
            node = select(select(next, next >> vec2<u32>(2u), rises), child, dips);
            level = select(select(level, level + 1u, rises), max(level, 1u) - 1u, dips);
        }
        steps += 1u;
        continuing { break if found || gone || steps >= MAX_STEPS; }
    }
    (*walk).t = t;
    (*walk).level = level;
    (*walk).node = node;
    (*walk).found = found;
    (*walk).texel = child;
    (*walk).t_past = t_past;
}

// First hit within one tile between t0 and t1. Stepping and visiting are loops of their own: lanes that have found a texel
// wait for the others, so that the costly visit is made together (Aila & Laine 2009, "while-while"). All loops here test at
// their end: a software device runs a body that it tests at the top once more than needed.
fn walk_tile(slot_index: i32, slot: TileRecord, tile: vec2<i32>, ray: Ray, t0: f32, t1: f32) -> Hit {
    var walk = enter_tile(slot_index, slot, tile_corner(tile), ray, t0, t1);
    var hit = MISS;
    var visits = 0u;
    loop {
        next_texel(&walk, ray);
        if walk.found {
            let code = textureLoad(cells, walk.texel, slot_index, 0).x;
            if code != 0u { hit = visit_cell(code, walk.texel, slot, ray, walk.start, walk.t, walk.t_past); }
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
    let step = select(vec2<i32>(-1), vec2<i32>(1), forward);
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
        let t_border = (tile_corner(tile) + lead * frame.tile_m - ray.start.xy) * ray.inverse;
        let t_out = nearer(t_border, end);
        if all((tile >= vec2<i32>(0))) && all((tile < frame.grid)) {
            let slot_index = textureLoad(tile_table, tile, 0).x;
            let slot = slot_at(max(slot_index, 0));
            // Of the way through the tile only what lies between its lowest ground and its highest roof: a ray that comes in
            // under the ground, past the city's edge, meets nothing.
            let t_low = (slot.min_height - frame.eye_elevation - ray.start.z) / ray.direction.z;
            let t_high = (slot.max_height - frame.eye_elevation - ray.start.z) / ray.direction.z;
            let t_first = min(t_low, t_high);
            let t_last = max(t_low, t_high);
            let from_t = max(t, t_first - slack(abs(t_first)));
            let to_t = min(t_out, t_last + slack(abs(t_last)));
            if slot_index >= 0 && from_t <= to_t {
                let met = walk_tile(slot_index, slot, tile, ray, from_t, to_t);
                if met.t <= end { hit = met; }
            }
        }
        t = max(t, t_out);
        tile += select(vec2<i32>(0, step.y), vec2<i32>(step.x, 0), t_border.x <= t_border.y);
        let gone = select((tile < vec2<i32>(0)), (tile >= frame.grid), forward);
        tiles += 1u;
        continuing { break if hit.t < FAR || t >= end || any(gone) || tiles >= MAX_STEPS; }
    }
    return hit;
}

// Outward unit normal of what was hit.
fn hit_normal(hit: Hit) -> vec3<f32> {
    if hit.edge == ROOF { return vec3<f32>(0.0, 0.0, 1.0); }
    let along = vertex_at(hit.edge + 1u).position - vertex_at(hit.edge).position;
    return normalize(vec3<f32>(along.y, -along.x, 0.0));
}

// Facade coordinate of what was hit: metres along the building's outline, 0 on a roof.
fn facade_coordinate(hit: Hit) -> f32 {
    if hit.edge == ROOF { return 0.0; }
    return along_outline[hit.edge] + hit.along_wall_m;
}
