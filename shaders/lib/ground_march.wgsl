// Rays against the ground: the way of sunlight past hills. Twin: src/relief/ground_march.rs.
//
// A ray passes blocks of ground that it stays above in one read of their maximum (maximum mipmaps: Tevs, Ihrke & Seidel 2008) and
// meets the DTM's own bilinear surface, cell by cell, in the others.

// Where a ray leaves a square, metres along it. `border`: the two sides ahead, in the coordinates of `start`.
fn leaves(border: vec2<f32>, start: vec2<f32>, ray: Ray) -> f32 {
    let t = (border - start) * ray.inverse;
    return min(t.x, t.y);
}

// First meeting with the bilinear surface of a cell between t0 and t1: a quadratic in t (Ramsey, Potter & Hansen 2004, "Ray
// Bilinear Patch Intersections", for a patch over a square). `start`: the ray's start in cells from the cell's corner.
fn meet_cell(h: vec4<f32>, step_m: f32, start: vec2<f32>, ray: Ray, t0: f32, t1: f32) -> f32 {
    let d = ray.direction.xy / step_m;
    // Counted from t0, for the sake of its digits.
    let p = start + t0 * d;
    let slope = vec2<f32>(h.y - h.x, h.z - h.x);
    let twist = h.x - h.y - h.z + h.w;
    // Height of the ray above the surface: c + b s + a s², s = t - t0.
    let c = ray.start.z + t0 * ray.direction.z + frame.eye_elevation - (h.x + dot(slope, p) + twist * p.x * p.y);
    if c <= 0.0 { return t0; }
    let b = ray.direction.z - dot(slope, d) - twist * (p.x * d.y + p.y * d.x);
    let a = -twist * d.x * d.y;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 { return FAR; }
    // The root at which the ray goes down through the surface, without cancellation.
    let s = 2.0 * c / (-b + sqrt(discriminant));
    return select(FAR, t0 + s, s >= 0.0 && t0 + s <= t1);
}

// First meeting with the ground of one tile between t0 and t1, cell by cell. `start`: the ray's start, metres from the tile's corner.
fn walk_cells(entry: TableEntry, start: vec2<f32>, ray: Ray, t0: f32, t1: f32) -> f32 {
    let step_m = terrain_step(entry.level);
    let lead = select(vec2<f32>(0.0), vec2<f32>(1.0), ray.direction.xy >= vec2<f32>(0.0));
    var t = t0;
    for (var i = 0u; i < MAX_STEPS; i += 1u) {
        let cell = cell_at((start + (t + slack(t)) * ray.direction.xy) / step_m);
        let t_past = min(t1, max(leaves((vec2<f32>(cell) + lead) * step_m, start, ray), t));
        let local = start / step_m - vec2<f32>(cell);
        let met = meet_cell(cell_heights(cell, u32(entry.slot)), step_m, local, ray, t, t_past);
        if met < FAR { return met; }
        t = max(t_past, t + slack(t));
        if t >= t1 { break; }
    }
    return FAR;
}

// Where a rising ray has passed what is no higher than `bound`, at most t1.
fn clears(bound: f32, ray: Ray, t1: f32) -> f32 {
    if ray.direction.z <= 0.0 { return t1; }
    let t = (bound - frame.eye_elevation - ray.start.z) / ray.direction.z;
    return min(t1, t + slack(abs(t)));
}

// First meeting with the ground of one tile between t0 and t1.
fn walk_ground_tile(entry: TableEntry, start: vec2<f32>, ray: Ray, t0: f32, t1: f32) -> f32 {
    let layer = entry.slot;
    let lead = select(vec2<f32>(0.0), vec2<f32>(1.0), ray.direction.xy >= vec2<f32>(0.0));
    // Only below the tile's highest ground.
    let end = clears(textureLoad(ground_bounds, vec2<i32>(0), layer, GROUND_LEVELS - 1u).x, ray, t1);
    var t = t0;
    if t >= end { return FAR; }
    var level = 0u;
    for (var i = 0u; i < MAX_STEPS; i += 1u) {
        let blocks = GROUND_BLOCKS >> level;
        let size = level_tile_m(entry.level) / f32(blocks);
        let position = (start + (t + slack(t)) * ray.direction.xy) / size;
        let block = clamp(vec2<i32>(floor(position)), vec2<i32>(0), vec2<i32>(blocks - 1));
        let t_past = min(end, max(leaves((vec2<f32>(block) + lead) * size, start, ray), t));
        let lowest = ray.start.z + min(t * ray.direction.z, t_past * ray.direction.z) + frame.eye_elevation;
        let bound = textureLoad(ground_bounds, block, layer, level).x;
        if lowest <= bound {
            if level > 0u {
                level -= 1u;
                continue;
            }
            let met = walk_cells(entry, start, ray, t, clears(bound, ray, t_past));
            if met < FAR { return met; }
        } else {
            level = min(level + 1u, GROUND_LEVELS - 1u);
        }
        t = max(t_past, t + slack(t));
        if t >= end { break; }
    }
    return FAR;
}

// First meeting with the ground of any tile between t0 and t1, FAR without one.
fn walk_ground(ray: Ray, t0: f32, t1: f32) -> f32 {
    let forward = ray.direction.xy >= vec2<f32>(0.0);
    let lead = select(vec2<f32>(0.0), vec2<f32>(1.0), forward);
    let min_border = tile_corner(vec2<i32>(0)) - ray.start.xy;
    let max_border = tile_corner(frame.grid) - ray.start.xy;
    let t_in = select(max_border, min_border, forward) * ray.inverse;
    let t_out = select(min_border, max_border, forward) * ray.inverse;
    var t = max(t0, max(t_in.x, t_in.y));
    var end = min(t1, min(t_out.x, t_out.y));
    // A rising ray has passed all ground at the height of the highest.
    let t_top = (frame.max_ground - ray.start.z) / ray.direction.z;
    if ray.direction.z > 0.0 { end = min(end, t_top); } else { t = max(t, t_top); }
    if t >= end { return FAR; }
    let position = frame.eye_in_tile + ray.start.xy + t * ray.direction.xy;
    var tile = frame.eye_tile + vec2<i32>(floor(position / frame.tile_m));
    for (var i = 0u; i < MAX_STEPS; i += 1u) {
        let entry = terrain_entry(tile);
        let first = tile_over(tile, entry.level);
        let corner = tile_corner(first);
        let t_border = (corner + lead * level_tile_m(entry.level) - ray.start.xy) * ray.inverse;
        let t_past = min(end, min(t_border.x, t_border.y));
        if entry.slot >= 0 && t_past > t {
            let met = walk_ground_tile(entry, ray.start.xy - corner, ray, t, t_past);
            if met < FAR { return met; }
        }
        t = max(t, t_past);
        tile = tile_past(first, entry.level, ray, t, t_border.x <= t_border.y);
        if t >= end { break; }
    }
    return FAR;
}
