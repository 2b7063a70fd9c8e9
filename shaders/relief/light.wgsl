// Lights what the passes before found: imagery on ground and roofs, plain plaster on walls, the sun past buildings and hills, the
// sky past buildings. A sample of a pixel sends one ray to a point of the sun's disc and one to the sky: many samples converge,
// and a single one has the same mean, only noisier.

@group(2) @binding(0) var ground_distance: texture_2d<f32>;
@group(2) @binding(1) var ground_normal: texture_2d<u32>;
// Bits of the distance, id, bits of the facade coordinate, packed normal.
@group(2) @binding(2) var relief_surface: texture_2d<u32>;
@group(2) @binding(3) var imagery: texture_2d_array<f32>;
@group(2) @binding(4) var imagery_sampler: sampler;

struct Shaded {
    // Linear radiance.
    @location(0) radiance: vec4<f32>,
    // Metres along the view ray, FAR for sky.
    @location(1) distance: f32,
    @location(2) id: u32,
}

// Three random numbers in 0..1 from three whole ones (pcg3d: Jarzynski & Olano 2020, JCGT 9(3)).
fn random3(seed: vec3<u32>) -> vec3<f32> {
    var v = seed * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> vec3<u32>(16u);
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    return vec3<f32>(v >> vec3<u32>(8u)) / 16777216.0;
}

// Imagery at an eye-relative position, linear; alpha 0 where there is none.
fn imagery_at(plan: vec2<f32>, t: f32, facing: f32) -> vec4<f32> {
    let tile = frame.eye_tile + vec2<i32>(floor((frame.eye_in_tile + plan) / frame.tile_m));
    let entry = imagery_entry(tile);
    if entry.slot < 0 { return vec4<f32>(0.0); }
    let tile_m = level_tile_m(entry.level);
    let uv = (plan - tile_corner(tile_over(tile, entry.level))) / tile_m;
    let pixels = t * frame.pixel_angle * frame.imagery_side / (tile_m * sqrt(max(facing, 0.05)));
    let colour = textureSampleLevel(imagery, imagery_sampler, vec2<f32>(uv.x, 1.0 - uv.y), entry.slot, log2(max(pixels, 1.0)));
    return colour;
}

fn roof_colour(fid: u32) -> vec3<f32> {
    let r = random3(vec3<u32>(fid, 11u, 5u));
    let tile = mix(vec3<f32>(0.36, 0.17, 0.10), vec3<f32>(0.45, 0.25, 0.16), r.y);
    let slate = vec3<f32>(0.20, 0.20, 0.21) * (0.8 + 0.5 * r.y);
    return select(slate, tile, r.x < 0.62);
}

fn wall_colour(fid: u32) -> vec3<f32> {
    let r = random3(vec3<u32>(fid, 3u, 7u));
    let plaster = mix(vec3<f32>(0.58, 0.52, 0.43), vec3<f32>(0.58, 0.43, 0.28), r.x);
    return mix(plaster, vec3<f32>(0.50, 0.49, 0.47), step(0.75, r.y)) * (0.85 + 0.25 * r.z);
}

fn bare_ground(normal: vec3<f32>) -> vec3<f32> {
    let grass = vec3<f32>(0.19, 0.21, 0.105);
    let rock = vec3<f32>(0.27, 0.25, 0.22);
    return mix(rock, grass, smoothstep(0.75, 0.97, normal.z));
}

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

// Length of a ray to the sky, metres: what stands farther away hides little of it.
const SKY_RAY_M: f32 = 60.0;
// Light that a ray brings which meets a wall, or the ground, by that of the sky: what those send on. Estimates.
const WALL_LIGHT: f32 = 0.45;
const GROUND_LIGHT: f32 = 0.8;

// What a surface gets along one ray to the sky and one to the sun: the fraction of the sky's light, and whether the sun is seen, past
// buildings and the ground.
struct Received {
    sky: f32,
    sun: bool,
}

fn receive(start: vec3<f32>, normal: vec3<f32>, to_sky: vec3<f32>, to_sun: vec3<f32>) -> Received {
    var received = Received(GROUND_LIGHT, false);
    // One loop for both rays: a device that inlines the walk does so once.
    for (var k = 0; k < 2; k += 1) {
        let is_sky = k == 0;
        let direction = select(to_sun, to_sky, is_sky);
        if direction.z > 0.0 && dot(normal, direction) > 0.0 {
            let is_open = walk_city(make_ray(start, direction), 0.0, select(FAR, SKY_RAY_M, is_sky)).t >= FAR;
            if is_sky { received.sky = select(WALL_LIGHT, 1.0, is_open); } else { received.sun = is_open; }
        }
    }
    if received.sun { received.sun = walk_ground(make_ray(start, to_sun), 0.0, FAR) >= FAR; }
    return received;
}

// Numbers in 0..1 for a pixel's sample. In the plane: three low-discrepancy masks, so that neighbours differ evenly (R2: Roberts 2018;
// interleaved gradient noise: Jimenez 2014). Along the samples: R3 (Roberts 2018).
fn sample_numbers(pixel: vec2<i32>, index: u32) -> vec3<f32> {
    let p = vec2<f32>(pixel);
    let mask = vec3<f32>(
        dot(p, vec2<f32>(0.75487767, 0.56984029)),
        52.9829189 * fract(dot(p, vec2<f32>(0.06711056, 0.00583715))),
        dot(p, vec2<f32>(0.56984029, 0.75487767)) + 0.5,
    );
    return fract(fract(mask) + f32(index) * vec3<f32>(0.8191725, 0.6710436, 0.5497005));
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> Shaded {
    let pixel = vec2<i32>(position.xy);
    let direction = ray_direction(position.xy);
    let t_ground = textureLoad(ground_distance, pixel, 0).x;
    let relief = textureLoad(relief_surface, pixel, 0);
    let t_relief = bitcast<f32>(relief.x);
    let t = min(t_ground, t_relief);
    if t >= FAR {
        return Shaded(vec4<f32>(sky_colour(direction) + sun_disc(direction), 1.0), FAR, 0u);
    }
    let at = direction * t;
    let is_ground = t_ground <= t_relief;
    var id = 0u;
    var normal: vec3<f32>;
    var albedo: vec3<f32>;
    if !is_ground {
        id = relief.y;
        normal = unpack_normal(relief.w);
        if normal.z > 0.5 {
            let seen = imagery_at(at.xy, t, abs(direction.z));
            albedo = mix(roof_colour(id), seen.rgb, seen.a);
        } else {
            albedo = wall_colour(id);
        }
    } else {
        normal = unpack_normal(textureLoad(ground_normal, pixel, 0).x);
        let seen = imagery_at(at.xy, t, abs(dot(direction, normal)));
        albedo = mix(bare_ground(normal), seen.rgb, seen.a);
    }
    let random = sample_numbers(pixel, frame.sample);
    let start = lifted(at, normal, is_ground);
    // The sky's half, cosine-weighted, and the sun's disc.
    let azimuth = 2.0 * PI * random.y;
    let to_sky = around(normal, sqrt(random.x), azimuth);
    let to_sun = around(frame.sun.xyz, frame.sun.w * sqrt(random.z), azimuth);
    let received = receive(start, normal, to_sky, to_sun);
    let sky = sky_irradiance(normal) * received.sky;
    let sun = select(vec3<f32>(0.0), frame.sun_irradiance.xyz * dot(normal, to_sun), received.sun);
    let radiance = albedo / PI * (sun + sky);
    return Shaded(vec4<f32>(through_haze(radiance, direction, t), 1.0), t, id);
}
