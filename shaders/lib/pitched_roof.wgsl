// Roofs of tiles and slate as they look from above: hipped, a slope from every edge of the outline up to where slopes meet (the straight
// skeleton: Aichholzer et al. 1995, J.UCS 1(12)). It is a texture with relief on the flat roof that the building map has: what is hit,
// its distance and its shadow stay those of the flat one.

// Rise of the slopes, metres a metre; how far from the eaves they end, metres: a wider roof is flat inside.
const PITCH: f32 = 0.5;
const SLOPE_M: f32 = 7.0;
// Widths of the gutter at the eaves and, to both sides, of the tiles over ridges and hips, metres; how much darker and lighter they are.
const EAVES_M: f32 = 0.14;
const RIDGE_M: f32 = 0.13;
const EAVES_DARK: f32 = 0.45;
const RIDGE: f32 = 1.25;
// Widths of a pixel between which slopes fade into a flat roof of their mean, and of those lines, metres.
const PITCHED_TO_M: vec2<f32> = vec2<f32>(1.2, 2.4);
const LINES_TO_M: vec2<f32> = vec2<f32>(0.2, 0.5);

// The slope of a roof that a place lies on.
struct RoofSlope {
    // Unit vector in plan from the eaves up, 0 on a roof that is not pitched.
    inwards: vec2<f32>,
    // Metres from the eaves; metres along them; metres to the next slope.
    from_eaves: f32,
    along: f32,
    to_next: f32,
}

const NO_SLOPE: RoofSlope = RoofSlope(vec2<f32>(0.0), 0.0, 0.0, FAR);

fn is_slope(slope: RoofSlope) -> bool { return dot(slope.inwards, slope.inwards) > 0.5; }

fn is_pitched(code: u32) -> bool { return roof_of(code) == TILES || roof_of(code) == SLATE; }

// The slope that a ray meets which comes to a place on the flat roof, metres from the tile's corner: what rises over the eaves stands
// before it. Under a hipped roof lies what lies under all its slopes, so that the ray comes in by the lowest that it meets going down.
// Where the outline juts in a slope goes on as far past its edge's end as it has come up (half a right angle), and what lies behind an
// edge has nothing to do with it. `first`: place of the outline's first vertex.
fn slope_met(place: vec2<f32>, direction: vec3<f32>, outline: RoofOutline, first: u32) -> RoofSlope {
    // Towards the eye, metres a metre of rise.
    let back = direction.xy / min(direction.z, -0.05);
    var slope = NO_SLOPE;
    slope.from_eaves = SLOPE_M;
    var a = vertex_at(first).position;
    for (var e = 0u; e < outline.edges; e += 1u) {
        let b = vertex_at(first + e + 1u).position;
        let length_m = max(distance(a, b), 1.0e-3);
        let along = (b - a) / length_m;
        // The building is to the left of its outline.
        let inwards = vec2<f32>(-along.y, along.x);
        let behind = dot(place - a, inwards);
        let closing = 1.0 - PITCH * dot(back, inwards);
        let from_eaves = behind / max(closing, 0.02);
        let u = dot(place + PITCH * from_eaves * back - a, along);
        let is_edge = ((outline.gaps >> e) & 1u) == 0u;
        let is_met = is_edge && behind >= 0.0 && closing > 0.0 && u > -from_eaves - 0.01 && u < length_m + from_eaves + 0.01;
        if is_met {
            let bend = max(distance(inwards, slope.inwards), 0.1);
            let apart = select(abs(from_eaves - slope.from_eaves) / bend, slope.to_next, bend == 0.1);
            if from_eaves < slope.from_eaves {
                slope = RoofSlope(inwards, from_eaves, u, apart);
            } else {
                slope.to_next = min(slope.to_next, apart);
            }
        }
        a = b;
    }
    return slope;
}

// A roof's material with its slope: the tiles run along the eaves. `size`: of a pixel on the roof, metres.
fn with_slope(roof: Material, slope: RoofSlope, size: f32) -> Material {
    let is_sloping = is_slope(slope);
    let pitch = select(0.0, PITCH, is_sloping) * (1.0 - smoothstep(PITCHED_TO_M.x, PITCHED_TO_M.y, size));
    let told = 1.0 - smoothstep(LINES_TO_M.x, LINES_TO_M.y, size);
    let eaves = 1.0 - smoothstep(EAVES_M - 0.5 * size, EAVES_M + 0.5 * size, slope.from_eaves);
    let ridge = 1.0 - smoothstep(RIDGE_M - 0.5 * size, RIDGE_M + 0.5 * size, slope.to_next);
    var material = roof;
    // A slope has more of the sun than its plan: its mean by the plan is the flat roof's.
    material.albedo *= sqrt(1.0 + pitch * pitch) * mix(1.0, mix(mix(1.0, RIDGE, ridge), EAVES_DARK, eaves), select(0.0, told, is_sloping));
    material.normal = normalize(roof.normal - vec3<f32>(pitch * slope.inwards, 0.0));
    return material;
}

// Height of the gutter along the top of a wall under a pitched roof and of the shade below it, metres; the parts of the wall's lightness
// that the gutter has, and that the shade has at its top.
const EAVES_GUTTER_M: f32 = 0.13;
const EAVES_SHADE_M: f32 = 0.32;
const EAVES_GUTTER_LIGHT: f32 = 0.2;
const EAVES_LIGHT: f32 = 0.55;
const MIN_WALL_M: f32 = 2.0;

// What gutter and shade take of a wall from its top down to a depth, metres of its lightness; above the top what they would mirrored, so
// that wide pixels take as much from the wall as narrow ones.
fn taken_by_eaves(depth: f32) -> f32 {
    let deep = abs(depth);
    let in_shade = clamp(deep - EAVES_GUTTER_M, 0.0, EAVES_SHADE_M);
    let taken = (1.0 - EAVES_GUTTER_LIGHT) * min(deep, EAVES_GUTTER_M) + (1.0 - EAVES_LIGHT) * in_shade * (1.0 - 0.5 * in_shade / EAVES_SHADE_M);
    return select(-taken, taken, depth >= 0.0);
}

// A wall's material under its roof's eaves; the mean of the wall, `height` metres high and no lower than MIN_WALL_M, stays its tiles'.
// `below_roof`; `tall`: of a pixel on the wall, metres.
fn under_eaves(wall: Material, code: u32, below_roof: f32, height: f32, tall: f32) -> Material {
    let wall_m = max(height, MIN_WALL_M);
    let size = min(tall, 2.0 * wall_m);
    let taken = (taken_by_eaves(below_roof + 0.5 * size) - taken_by_eaves(below_roof - 0.5 * size)) / size;
    let mean = 1.0 - taken_by_eaves(EAVES_SHADE_M + EAVES_GUTTER_M) / wall_m;
    let light = select(1.0, (1.0 - taken) / mean, is_pitched(code));
    var material = wall;
    material.albedo *= light;
    material.glass *= min(light, 1.0);
    return material;
}

// The slope that is seen at a place, metres from the eye. `roof`: its place in the building map, 0 if unknown; `size`: of a pixel, metres.
fn roof_slope(code: u32, at: vec2<f32>, direction: vec3<f32>, roof: u32, size: f32) -> RoofSlope {
    let tile = frame.eye_tile + vec2<i32>(floor((frame.eye_in_tile + at) / frame.tile_m));
    var outline = RoofOutline(0u, 0u, 0u, 0u);
    if roof != 0u && is_pitched(code) && size < PITCHED_TO_M.y { outline = roof_outline(roof); }
    return slope_met(at - tile_corner(tile), direction, outline, roof + outline.vertex);
}

// The direction that roofing is laid along: the eaves, or the building.
fn roof_direction(slope: RoofSlope, code: u32) -> vec2<f32> {
    return select(roof_along(code), vec2<f32>(slope.inwards.y, -slope.inwards.x), is_slope(slope));
}

// Metres along the roofing and across it. `plan`: metres, of any origin that stays.
fn roofing_position(slope: RoofSlope, code: u32, plan: vec2<f32>) -> vec2<f32> {
    let along = roof_direction(slope, code);
    let across = vec2<f32>(-along.y, along.x);
    return select(vec2<f32>(dot(plan, along), dot(plan, across)), vec2<f32>(slope.along, slope.from_eaves * sqrt(1.0 + PITCH * PITCH)), is_slope(slope));
}
