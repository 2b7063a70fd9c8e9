// Rays that leave a surface for the light.

// Rays leave a surface from so far above it, metres: a fixed part, and what the rounding of a distance takes.
const LIFT: vec2<f32> = vec2<f32>(0.01, 4.0e-6);

// Where light that falls on a surface comes from: the surface, lifted. On the ground not below the DTM's own surface, from which
// a far triangle may depart.
fn lifted(at: vec3<f32>, normal: vec3<f32>, is_ground: bool) -> vec3<f32> {
    let lift = LIFT.x + LIFT.y * length(at);
    let start = at + normal * lift;
    if !is_ground { return start; }
    let tile = frame.eye_tile + vec2<i32>(floor((frame.eye_in_tile + start.xy) / frame.tile_m));
    let entry = terrain_entry(tile);
    if entry.slot < 0 { return start; }
    let local = start.xy - tile_corner(tile_over(tile, entry.level));
    let surface = surface_at(local / terrain_step(entry.level), u32(entry.slot), entry.level);
    return vec3<f32>(start.xy, max(start.z, surface.height + lift));
}

// A rotation about `axis`: a unit vector at `radius` (sine) and `azimuth` from it.
fn around(axis: vec3<f32>, radius: f32, azimuth: f32) -> vec3<f32> {
    let pole = select(vec3<f32>(0.0, 0.0, 1.0), vec3<f32>(1.0, 0.0, 0.0), abs(axis.z) > 0.9);
    let side = normalize(cross(axis, pole));
    let across = cross(axis, side);
    let plan = radius * (cos(azimuth) * side + sin(azimuth) * across);
    return plan + sqrt(max(1.0 - radius * radius, 0.0)) * axis;
}

// Where a ray to the sky ends.
const MEETS_GROUND: u32 = 0u;
const MEETS_WALL: u32 = 1u;
const MEETS_SKY: u32 = 2u;
const MEETS_SUNNY_WALL: u32 = 3u;

// Whether a wall that a ray meets faces the sun: it faces the ray.
fn faces_sun(direction: vec3<f32>) -> bool { return dot(direction.xy, frame.sun.xy) < 0.0; }

// What such a wall sends on, and another.
fn wall_light(is_sunny: bool) -> vec3<f32> {
    return select(frame.wall_light.rgb, frame.sunny_wall_light.rgb, is_sunny);
}

// A packed normal that no surface has (packing gives no -32768): the pixel shows none.
const NO_SURFACE: u32 = 0x80008000u;

// The pixel whose ray a pixel of the ambient pass casts: one of its four, by the sample, so that many samples cast all.
fn sampled_pixel(place: vec2<i32>) -> vec2<i32> {
    let step = vec2<u32>(frame.sample & 1u, ((frame.sample + 1u) >> 1u) & 1u);
    return min(2 * place + vec2<i32>(step), vec2<i32>(frame.size) - 1);
}
