// Light from all round: for every second pixel of every second row one ray over the surface's half of the sphere, drawn by the cosine,
// and where it ends. The light pass takes what it needs of it.

@group(2) @binding(0) var ground_distance: texture_2d<f32>;
@group(2) @binding(1) var ground_normal: texture_2d<u32>;
// `BuildingTexels`.
@group(2) @binding(2) var relief_surface: texture_2d<u32>;

const PI: f32 = 3.14159265;

// Length of a ray to the sky, metres: what stands farther away hides little of it.
const SKY_RAY_M: f32 = 60.0;

// Bits of the distance of the surface, the last two telling where the ray ends; its packed normal.
@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec2<u32> {
    let pixel = sampled_pixel(vec2<i32>(position.xy));
    let t_ground = textureLoad(ground_distance, pixel, 0).x;
    let relief = textureLoad(relief_surface, pixel, 0);
    let t_relief = bitcast<f32>(relief.x);
    let t = min(t_ground, t_relief);
    if t >= FAR { return vec2<u32>(0u, NO_SURFACE); }
    let is_ground = t_ground <= t_relief;
    let packed = select(relief.w, textureLoad(ground_normal, pixel, 0).x, is_ground);
    let normal = unpack_normal(packed);
    let start = lifted(ray_direction(vec2<f32>(pixel) + 0.5) * t, normal, is_ground);
    let random = sample_numbers(vec2<i32>(position.xy), frame.sample);
    let to_sky = around(normal, sqrt(random.x), 2.0 * PI * random.y);
    var meets = MEETS_GROUND;
    if to_sky.z > 0.0 {
        let is_open = walk_city(make_ray(start, to_sky), 0.0, SKY_RAY_M).t >= FAR;
        meets = select(select(MEETS_WALL, MEETS_SUNNY_WALL, faces_sun(to_sky)), MEETS_SKY, is_open);
    }
    return vec2<u32>((bitcast<u32>(t) & ~3u) | meets, packed);
}
