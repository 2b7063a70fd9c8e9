// How far the rays of a block of pixels can go at least before any of them meets a building: the exact walk begins there.
//
// Rays of neighbouring pixels cross the same empty air. Here one cone round all rays of a block walks the pyramid with
// coarse steps, and stops where its narrowest fitting blocks hold a roof within reach (cone optimisation: Laine & Karras
// 2011, "Efficient Sparse Voxel Octrees", section 4.5). The bound is conservative, so the picture is the same without.

// Along the way a block of the pyramid is at least this many times as wide as the cone's radius.
const WIDTH_IN_RADII: f32 = 4.0;
const MAX_CONE_STEPS: u32 = 1024u;
// Rounding of places, metres.
const CONE_SLACK: f32 = 0.01;
// Highest roof over a place without a building map.
const NOTHING: f32 = -1.0e9;

// Bound on the roofs of a pyramid block, metres above the vertical datum, by its place in a grid of such blocks over the whole
// city.
fn highest_of(block: vec2<i32>, level: u32) -> f32 {
    let tile = block >> vec2<u32>(frame.tile_texels_log2 - level);
    let entry = map_entry(tile);
    if entry.slot < 0 { return NOTHING; }
    let record = slot_at(entry.slot);
    // Of a coarser map the block that lies over this one, which no map has finer than 4 x 4 texels.
    let own_level = max(i32(level) - i32(entry.level), 2);
    let shift = u32(own_level + i32(entry.level)) - level;
    let first_block = tile_over(tile, entry.level) << vec2<u32>(frame.tile_texels_log2 - level);
    let local = (block - first_block) >> vec2<u32>(shift);
    // A block is a child of a node or, at odd levels, four of them.
    let odd = vec2<i32>(own_level & 1);
    let first = local << vec2<u32>(odd);
    let rows = node_at(first >> vec2<u32>(2u), u32(own_level) >> 1u, record);
    let highest = max(
        max(child_byte(rows, first), child_byte(rows, first + odd)),
        max(child_byte(rows, first + odd * vec2<i32>(1, 0)), child_byte(rows, first + odd * vec2<i32>(0, 1))),
    );
    return select(record.min_height + (f32(highest) - 1.0) * step_of(record), NOTHING, highest == 0u);
}

// Earliest t at which the cone, t * (d +- spread), can reach the interval low..high.
fn first_reach(low: f32, high: f32, d: f32, spread: f32) -> f32 {
    if low > 0.0 { return select(FAR, low / (d + spread), d + spread > 0.0); }
    if high < 0.0 { return select(FAR, high / (d - spread), d - spread < 0.0); }
    return 0.0;
}

// t from which the whole cone has passed the upper (d > 0) or lower (d < 0) end of the interval.
fn last_reach(low: f32, high: f32, d: f32, spread: f32) -> f32 {
    if d - spread > 0.0 { return high / (d - spread); }
    if d + spread < 0.0 { return low / (d + spread); }
    return FAR;
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    // Pixel centres of the block lie within half a pixel of its border.
    let first = floor(position.xy) * f32(CONE_PIXELS) + 0.5;
    let last = first + f32(CONE_PIXELS) - 1.0;
    let d = ray_direction(0.5 * (first + last));
    // The directions of the block lie within this distance of the centre one, because its corners do.
    var spread = 0.0;
    for (var corner = 0u; corner < 4u; corner += 1u) {
        let pixel = select(first, last, vec2<bool>((corner & 1u) == 1u, (corner & 2u) == 2u));
        spread = max(spread, distance(d, ray_direction(pixel)));
    }
    // Rounding of directions.
    spread += 1.0e-6;

    let low = tile_corner(vec2<i32>(0));
    let high = tile_corner(frame.grid);
    // Below any ground, metres.
    let deepest = -1.0e6;
    var t = max(
        max(first_reach(low.x, high.x, d.x, spread), first_reach(low.y, high.y, d.y, spread)),
        first_reach(deepest, frame.max_roof, d.z, spread),
    );
    let end = min(
        min(last_reach(low.x, high.x, d.x, spread), last_reach(low.y, high.y, d.y, spread)),
        last_reach(deepest, frame.max_roof, d.z, spread),
    );
    let fastest = max(abs(d.x), abs(d.y)) + 2.0 * spread;
    var level = frame.tile_texels_log2;
    for (var i = 0u; i < MAX_CONE_STEPS && t < end; i += 1u) {
        let size = frame.texel_m * f32(1u << level);
        // So far that what the cone sweeps in plan is no wider than a block.
        let reach = size - 2.0 * (spread * t + CONE_SLACK);
        // So far away that the cone is wider than a tile.
        if reach <= 0.0 { break; }
        let t_next = t + reach / fastest;
        let radius = spread * t_next + CONE_SLACK;
        // In tiles first: a place in a large city has too many digits.
        let base = vec2<f32>(frame.eye_in_tile);
        let from_block = vec2<i32>(floor((base + min(t * d.xy, t_next * d.xy) - radius) / size));
        let to_block = vec2<i32>(floor((base + max(t * d.xy, t_next * d.xy) + radius) / size));
        let origin = frame.eye_tile << vec2<u32>(frame.tile_texels_log2 - level);
        let highest = max(
            max(highest_of(origin + from_block, level), highest_of(origin + vec2<i32>(to_block.x, from_block.y), level)),
            max(highest_of(origin + vec2<i32>(from_block.x, to_block.y), level), highest_of(origin + to_block, level)),
        );
        let lowest = min(t * d.z, t_next * d.z) - radius;
        if lowest > highest - frame.eye_elevation {
            t = t_next;
            level = min(level + 1u, frame.tile_texels_log2);
        } else if level > 2u && 0.5 * size >= WIDTH_IN_RADII * (spread * t + CONE_SLACK) {
            level -= 1u;
        } else {
            break;
        }
    }
    return select(t, FAR, t >= end);
}
