// Lights what the passes before found: orthophoto on ground and roofs, plain plaster on walls, sun with shadows, sky.

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

// Imagery at an eye-relative place, linear; alpha 0 where there is none.
fn imagery_at(plan: vec2<f32>, t: f32, facing: f32) -> vec4<f32> {
    let place = (frame.eye_in_tile + plan) / frame.tile_m;
    let tile = frame.eye_tile + vec2<i32>(floor(place));
    if any((tile < vec2<i32>(0))) || any((tile >= frame.grid)) || frame.imagery_side <= 1.0 { return vec4<f32>(0.0); }
    let layer = textureLoad(tile_table, tile, 0).y;
    if layer < 0 { return vec4<f32>(0.0); }
    let uv = fract(place);
    let pixels = t * frame.pixel_angle * frame.imagery_side / (frame.tile_m * sqrt(max(facing, 0.05)));
    let colour = textureSampleLevel(imagery, imagery_sampler, vec2<f32>(uv.x, 1.0 - uv.y), layer, log2(max(pixels, 1.0)));
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

fn is_open(at: vec3<f32>, normal: vec3<f32>, direction: vec3<f32>, reach: f32) -> bool {
    let start = at + normal * (0.01 + 4.0e-6 * length(at));
    return walk_city(make_ray(start, direction), 0.0, reach).t >= FAR;
}

// Whether the sun's disc and the sky's half are sampled, one ray each; else one ray to the sun's centre. A constant of
// the pipeline, because a software device runs both sides of a branch.
override STOCHASTIC: bool = false;

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
    var id = 0u;
    var normal: vec3<f32>;
    var albedo: vec3<f32>;
    if t_relief < t_ground {
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
    // Every pixel walks the same low-discrepancy sequence (R3: Roberts 2018) from a place of its own.
    let random = fract(random3(vec3<u32>(vec2<u32>(pixel), 1u)) + f32(frame.sample) * vec3<f32>(0.8191725, 0.6710436, 0.5497005));
    var to_sun = frame.sun.xyz;
    var sky_share = 1.0;
    if STOCHASTIC {
        // A point of the solar disc, and one ray of the sky's half, cosine-weighted.
        let turn = 6.2831853 * random.y;
        let side = normalize(cross(normal, select(vec3<f32>(0.0, 0.0, 1.0), vec3<f32>(1.0, 0.0, 0.0), abs(normal.z) > 0.9)));
        let across = cross(normal, side);
        let r = sqrt(random.x);
        let up = sqrt(1.0 - random.x);
        let ambient_ray = normalize(r * cos(turn) * side + r * sin(turn) * across + up * normal);
        if ambient_ray.z <= 0.0 || !is_open(at, normal, ambient_ray, 60.0) { sky_share = 0.45; }
        if ambient_ray.z <= 0.0 { sky_share = 0.8; }
        let disc_side = normalize(cross(to_sun, vec3<f32>(0.0, 0.0, 1.0)));
        let wide = 0.0046 * sqrt(random.z);
        to_sun = normalize(to_sun + wide * (cos(turn) * disc_side + sin(turn) * cross(to_sun, disc_side)));
    }
    let facing = max(dot(normal, to_sun), 0.0);
    var sun = vec3<f32>(0.0);
    if facing > 0.0 && to_sun.z > 0.0 && is_open(at, normal, to_sun, FAR) { sun = sun_colour() * facing; }
    let radiance = albedo * (sun + sky_share * ambient_light(normal)) / 2.5;
    return Shaded(vec4<f32>(through_haze(radiance, direction, t), 1.0), t, id);
}
