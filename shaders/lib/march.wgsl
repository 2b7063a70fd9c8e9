// The one traversal: view rays, shadow rays and picking. Twin: src/relief/march.rs.
//
// A ray walks the quadtree of highest roofs (`pyramid`): what it stays above of a block is skipped in one read
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
    // Index into `roofs`.
    building: u32,
    // Index into `vertices` of the wall's first vertex, ROOF for a roof.
    edge: u32,
    // Metres along the wall from that vertex, 0 on a roof.
    along_m: f32,
}

const ROOF: u32 = 0xffffffffu;
const MISS: Hit = Hit(FAR, 0u, 0u, 0.0);
// More steps than any walk needs; a guard against endless loops, not a limit on quality.
const MOST_STEPS: u32 = 8192u;

fn make_ray(start: vec3<f32>, direction: vec3<f32>) -> Ray {
    let tiny = vec2<f32>(1.0e-9);
    let d = select(direction.xy, select(-tiny, tiny, direction.xy >= vec2<f32>(0.0)), abs(direction.xy) < tiny);
    return Ray(start, vec3<f32>(d, direction.z), 1.0 / d);
}

fn cross2(a: vec2<f32>, b: vec2<f32>) -> f32 { return a.x * b.y - a.y * b.x; }

// Rounding of a hit's place along the ray, metres.
fn slack(t: f32) -> f32 { return 1.0e-3 + 2.0e-6 * t; }

// First hit of the ray with the roofs and walls of one texel, between t0 and t1.
// `start` is the ray's start in the tile's local coordinates.
fn visit_cell(word: u32, cell: vec2<i32>, slot: TileSlot, ray: Ray, start: vec2<f32>, t0: f32, t1: f32) -> Hit {
    var best = MISS;
    let from_t = t0 - slack(t0);
    let to_t = t1 + slack(t1);
    let reference = (vec2<f32>(cell) + REFERENCE) * frame.texel_m;
    let is_list = kind_of(word) == KIND_LIST;
    let list = slot.piece_base + index_of(word);
    var count = 1u;
    if is_list { count = pieces[list]; }
    var i = 0u;
    loop {
        var w = word;
        if is_list { w = pieces[list + 1u + i]; }
        i += 1u;
        let is_run = kind_of(w) == KIND_RUN;
        var run = slot.vertex_base + index_of(w);
        var building = slot.roof_base;
        if is_run { building += vertices[run].building; } else { building += index_of(w); }
        let roof = roofs[building].roof_m - frame.eye_elevation;
        let t_roof = (roof - ray.start.z) / ray.direction.z;
        let meets_roof = ray.direction.z < 0.0 && t_roof >= from_t && t_roof <= to_t && t_roof < best.t;
        // A ray that stays above the roof can meet none of its walls.
        let dips = ray.start.z + min(from_t * ray.direction.z, to_t * ray.direction.z) <= roof;
        var inside = true;
        if is_run && dips {
            inside = is_inside(w);
            let p = start + t_roof * ray.direction.xy;
            let to_p = p - reference;
            var a = vertices[run].position;
            var edges_left = edges_of(w);
            var left = true;
            loop {
                let b = vertices[run + 1u].position;
                let along = b - a;
                // The building is to the left of its outline: the wall faces right.
                let facing = cross2(ray.direction.xy, along);
                let t = cross2(a - start, along) / facing;
                let u = dot(start + t * ray.direction.xy - a, along) / dot(along, along);
                let low_enough = ray.start.z + t * ray.direction.z <= roof;
                if facing < 0.0 && t >= from_t && t <= to_t && t < best.t && low_enough && u >= -1.0e-5 && u <= 1.00001 {
                    best = Hit(t, building, run, u * length(along));
                }
                if meets_roof {
                    let apart = (cross2(to_p, a - reference) >= 0.0) != (cross2(to_p, b - reference) >= 0.0);
                    let between = (cross2(along, reference - a) >= 0.0) != (cross2(along, p - a) >= 0.0);
                    inside = inside != (apart && between);
                }
                a = b;
                run += 1u;
                edges_left -= 1u;
                if edges_left == 0u {
                    // More edges of the same outline in the list's next word.
                    left = has_more(w) && i < count;
                    if left {
                        w = pieces[list + 1u + i];
                        i += 1u;
                        run = slot.vertex_base + index_of(w);
                        a = vertices[run].position;
                        edges_left = edges_of(w);
                    }
                }
                continuing { break if !left; }
            }
        }
        if meets_roof && inside && t_roof < best.t { best = Hit(t_roof, building, ROOF, 0.0); }
        continuing { break if i >= count; }
    }
    return best;
}

fn nearer(t: vec2<f32>, end: f32) -> f32 { return min(min(t.x, t.y), end); }

// The value of one quarter: `upper` tells whether it is the upper one in x and in y.
fn quarter_of(quarters: vec4<f32>, upper: vec2<bool>) -> f32 {
    let row = select(quarters.xy, quarters.zw, upper.y);
    return select(row.x, row.y, upper.x);
}

// Where a ray is in one tile, and the texel to look into when there is one.
struct Walk {
    slot_index: i32,
    // The ray's start in the tile's local coordinates; lowest ground, metres above the ray's start.
    start: vec2<f32>,
    floor_z: f32,
    // Metres along the ray: here, and at the end of the walk.
    t: f32,
    end: f32,
    // The block of 2^level texels that the ray is in.
    level: u32,
    block: vec2<i32>,
    // The texel, where the ray comes into it and leaves it; found is false past the tile.
    found: bool,
    texel: vec2<i32>,
    t_in: f32,
    t_past: f32,
}

// The beginning of the ray's way through a tile from t0 to t1.
fn enter_tile(slot_index: i32, slot: TileSlot, ray: Ray, t0: f32, t1: f32) -> Walk {
    let start = ray.start.xy - tile_corner(slot.tile);
    let top = frame.top_level;
    // Begin with blocks about half as large as the way to go: a short way need not come down from the tile's top.
    let reach = length(ray.direction.xy) * (t1 - t0) / frame.texel_m;
    let level = u32(clamp(ceil(log2(max(reach, 1.0))) - 1.0, 1.0, f32(top)));
    let place = (start + t0 * ray.direction.xy) / (frame.texel_m * f32(1u << level));
    let block = clamp(vec2<i32>(floor(place)), vec2<i32>(0), vec2<i32>((1 << (top - level)) - 1));
    let floor_z = slot.low - frame.eye_elevation - ray.start.z;
    return Walk(slot_index, start, floor_z, t0, t1, level, block, false, vec2<i32>(0), t0, t0);
}

// On to the next texel that the ray dips into. One read tells the highest roofs of a block's four quarters; the ray meets
// at most three of them, in order, and goes down into the first that it does not stay above.
fn next_texel(walk: ptr<function, Walk>, ray: Ray) {
    let forward = ray.direction.xy >= vec2<f32>(0.0);
    let step = select(vec2<i32>(-1), vec2<i32>(1), forward);
    let lead = select(vec2<f32>(0.0), vec2<f32>(1.0), forward);
    let falls = ray.direction.z < 0.0;
    let top = frame.top_level;
    let start = (*walk).start;
    let t1 = (*walk).end;
    var t = (*walk).t;
    var level = (*walk).level;
    var block = (*walk).block;
    var texel = vec2<i32>(0);
    var t_in = t;
    var t_past = t;
    var found = false;
    var steps = 0u;
    loop {
        let size = frame.texel_m * f32(1u << level);
        let t_border = ((vec2<f32>(block) + lead) * size - start) * ray.inverse;
        let t_middle = ((vec2<f32>(block) + 0.5) * size - start) * ray.inverse;
        let t_out = nearer(t_border, t1);
        let highest = highest_quarters(block, level, (*walk).slot_index) + ((*walk).floor_z + slack(t));
        // The three quarters on the way, each by the middle lines that lie behind the ray when it is in it.
        let beyond_a = vec2<f32>(t) >= t_middle;
        let t_a = nearer(select(t_middle, vec2<f32>(t_out), beyond_a), t_out);
        let beyond_b = beyond_a | (vec2<f32>(t_a) >= t_middle);
        let t_b = nearer(select(t_middle, vec2<f32>(t_out), beyond_b), t_out);
        let beyond_c = beyond_b | (vec2<f32>(t_b) >= t_middle);
        let lowest = select(vec3<f32>(t, t_a, t_b), vec3<f32>(t_a, t_b, t_out), falls) * ray.direction.z;
        let dips_a = t_a > t && lowest.x <= quarter_of(highest, beyond_a == forward);
        let dips_b = t_b > t_a && lowest.y <= quarter_of(highest, beyond_b == forward);
        let dips_c = t_out > t_b && lowest.z <= quarter_of(highest, beyond_c == forward);
        let dips = dips_a || dips_b || dips_c;
        if dips {
            let beyond = select(select(beyond_c, beyond_b, dips_b), beyond_a, dips_a);
            texel = 2 * block + select(vec2<i32>(0), vec2<i32>(1), beyond == forward);
            t_in = select(select(t_b, t_a, dips_b), t, dips_a);
            t_past = select(select(t_out, t_b, dips_b), t_a, dips_a);
            found = level == 1u;
        }
        // Else over the nearer border, and up when that is the parent's border too.
        let along_x = t_border.x <= t_border.y;
        let next = block + select(vec2<i32>(0, step.y), vec2<i32>(step.x, 0), along_x);
        let upper = select(next + 1, next, forward);
        let moved = select(upper.y, upper.x, along_x);
        let gone = !dips && (t_out >= t1 || t >= t1 || moved <= 0 || moved >= (1 << (top - level)));
        let rises = level < top && (moved & 1) == 0;
        if !found {
            t = select(max(t, t_out), t_in, dips);
            block = select(select(next, next >> vec2<u32>(1u), rises), texel, dips);
            level = select(select(level, level + 1u, rises), level - 1u, dips);
        }
        steps += 1u;
        continuing { break if found || gone || steps >= MOST_STEPS; }
    }
    (*walk).t = t;
    (*walk).level = level;
    (*walk).block = block;
    (*walk).found = found;
    (*walk).texel = texel;
    (*walk).t_in = t_in;
    (*walk).t_past = t_past;
}

// First hit within one tile between t0 and t1. Stepping and visiting are loops of their own: lanes that have found a texel
// wait for the others, so that the costly visit is made together (Aila & Laine 2009, "while-while"). All loops here test at
// their end: a software device runs a body that it tests at the top once more than needed.
fn walk_tile(slot_index: i32, ray: Ray, t0: f32, t1: f32) -> Hit {
    let slot = slots[slot_index];
    var walk = enter_tile(slot_index, slot, ray, t0, t1);
    next_texel(&walk, ray);
    var hit = MISS;
    var visits = 0u;
    loop {
        if walk.found {
            let word = textureLoad(cells, walk.texel, slot_index, 0).x;
            if word != 0u { hit = visit_cell(word, walk.texel, slot, ray, walk.start, walk.t_in, walk.t_past); }
            if hit.t >= FAR {
                walk.t = walk.t_past;
                next_texel(&walk, ray);
            }
        }
        visits += 1u;
        continuing { break if hit.t < FAR || !walk.found || visits >= MOST_STEPS; }
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
    let t_roofs = (frame.highest_roof - ray.start.z) / ray.direction.z;
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
            let slot = textureLoad(tile_table, tile, 0).x;
            let lowest = ray.start.z + min(t * ray.direction.z, t_out * ray.direction.z);
            if slot >= 0 && lowest <= slots[slot].high - frame.eye_elevation {
                let met = walk_tile(slot, ray, t, t_out);
                if met.t <= end { hit = met; }
            }
        }
        t = max(t, t_out);
        tile += select(vec2<i32>(0, step.y), vec2<i32>(step.x, 0), t_border.x <= t_border.y);
        let gone = select((tile < vec2<i32>(0)), (tile >= frame.grid), forward);
        tiles += 1u;
        continuing { break if hit.t < FAR || t >= end || any(gone) || tiles >= MOST_STEPS; }
    }
    return hit;
}

// Outward unit normal of what was hit.
fn hit_normal(hit: Hit) -> vec3<f32> {
    if hit.edge == ROOF { return vec3<f32>(0.0, 0.0, 1.0); }
    let along = vertices[hit.edge + 1u].position - vertices[hit.edge].position;
    return normalize(vec3<f32>(along.y, -along.x, 0.0));
}

// Facade coordinate of what was hit: metres along the building's outline, 0 on a roof.
fn facade_coordinate(hit: Hit) -> f32 {
    if hit.edge == ROOF { return 0.0; }
    return vertices[hit.edge].along_m + hit.along_m;
}
