// Lights what the passes before found: imagery on ground and roofs, facades on walls, the sun past buildings and hills, the sky past
// buildings. A sample of a pixel sends one ray to a point of the sun's disc and one to the sky: many samples converge,
// and a single one has the same mean, only noisier.

@group(2) @binding(0) var ground_distance: texture_2d<f32>;
@group(2) @binding(1) var ground_normal: texture_2d<u32>;
// `BuildingTexels`.
@group(2) @binding(2) var relief_surface: texture_2d<u32>;
@group(2) @binding(3) var relief_facade: texture_2d<u32>;
@group(2) @binding(4) var imagery: texture_2d_array<f32>;
@group(2) @binding(5) var imagery_sampler: sampler;

struct Shaded {
    // Linear radiance.
    @location(0) radiance: vec4<f32>,
    // Metres along the view ray, FAR for sky.
    @location(1) distance: f32,
    @location(2) id: u32,
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

// Paper-like ground where the survey has no imagery: warm grey with contour lines, as on a plan.
const PAPER: vec3<f32> = vec3<f32>(0.37, 0.352, 0.305);
const CONTOUR: vec3<f32> = vec3<f32>(0.23, 0.175, 0.12);
// Metres between contours near by; every fifth is bolder. Width of a line, metres and pixels at least.
const CONTOUR_M: f32 = 2.0;
const LINE_M: f32 = 0.35;
const LINE_PIXELS: f32 = 1.2;

// How much of a pixel contours of an interval cover. `slope`: metres a metre.
fn contour(height: f32, interval: f32, slope: f32, pixel_m: f32) -> f32 {
    let away = abs(height - round(height / interval) * interval) / max(slope, 1.0e-3);
    let width = max(LINE_M, LINE_PIXELS * pixel_m);
    // On level ground a contour would be an area; far away lines would merge.
    let spacing = interval / max(slope, 1.0e-3);
    let fades = smoothstep(0.01, 0.04, slope) * smoothstep(4.0, 10.0, spacing / width);
    return fades * (1.0 - smoothstep(0.5 * width - 0.5 * pixel_m, 0.5 * width + 0.5 * pixel_m, away));
}

fn bare_ground(height: f32, normal: vec3<f32>, direction: vec3<f32>, pixel_m: f32) -> vec3<f32> {
    let slope = length(normal.xy) / max(normal.z, 0.05);
    let size = pixel_m / sqrt(max(abs(dot(direction, normal)), 0.05));
    let lines = max(
        max(0.45 * contour(height, CONTOUR_M, slope, size), 0.75 * contour(height, 5.0 * CONTOUR_M, slope, size)),
        0.75 * contour(height, 25.0 * CONTOUR_M, slope, size),
    );
    return mix(PAPER, CONTOUR, lines);
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
// What walls across a street send on of the light that falls on level ground and of the sun's: reflectance, the part of them in the
// sun, its mean cosine. And what the ground before a wall gets of the open ground's light, for the shadows on it. Estimates.
const WALL_ALBEDO: f32 = 0.33;
const WALLS_IN_SUN: f32 = 0.28;
const WALLS_SKY: f32 = 0.60;
const GROUND_OPEN: f32 = 0.75;

// Where a ray to the sky ends.
const MEETS_GROUND: u32 = 0u;
const MEETS_WALL: u32 = 1u;
const MEETS_SKY: u32 = 2u;

// What a surface gets along one ray to the sky and one to the sun: where the one ends, and whether the sun is seen, past buildings
// and the ground.
struct Received {
    sky: u32,
    sun: bool,
}

// Irradiance from all round, by where the one ray of it ends.
fn ambient(normal: vec3<f32>, meets: u32) -> vec3<f32> {
    let open = sky_irradiance(normal);
    if meets == MEETS_SKY { return open; }
    if meets == MEETS_GROUND { return GROUND_OPEN * open; }
    let up = sky_irradiance(vec3<f32>(0.0, 0.0, 1.0));
    return WALL_ALBEDO * (WALLS_IN_SUN * frame.sun_irradiance.xyz + WALLS_SKY * up);
}

fn receive(start: vec3<f32>, normal: vec3<f32>, to_sky: vec3<f32>, to_sun: vec3<f32>) -> Received {
    var received = Received(MEETS_GROUND, false);
    // One loop for both rays: a device that inlines the walk does so once.
    for (var k = 0; k < 2; k += 1) {
        let is_sky = k == 0;
        let direction = select(to_sun, to_sky, is_sky);
        if direction.z > 0.0 && dot(normal, direction) > 0.0 {
            let is_open = walk_city(make_ray(start, direction), 0.0, select(FAR, SKY_RAY_M, is_sky)).t >= FAR;
            if is_sky { received.sky = select(MEETS_WALL, MEETS_SKY, is_open); } else { received.sun = is_open; }
        }
    }
    if received.sun { received.sun = walk_ground(make_ray(start, to_sun), 0.0, FAR) >= FAR; }
    return received;
}

// Reflectance of glass at normal incidence (index 1.52); exponent of its gloss.
const GLASS_REFLECTANCE: f32 = 0.0426;
const GLASS_GLOSS: f32 = 1800.0;
// What stands across a street, as a window mirrors it: metres away, as high as the window's own building. An estimate: no ray is cast.
const STREET_M: f32 = 16.0;
// Radiance of a lit window at night.
const LAMP: vec3<f32> = vec3<f32>(0.017, 0.0098, 0.0040);

// Radiance that a pane sends on: what it mirrors of sky, street and sun; and how much it lets through.
struct Mirrored {
    radiance: vec3<f32>,
    passes: f32,
}

fn mirrored(direction: vec3<f32>, normal: vec3<f32>, below_roof: f32, received: Received) -> Mirrored {
    let facing = max(-dot(direction, normal), 0.0);
    let reflectance = GLASS_REFLECTANCE + (1.0 - GLASS_REFLECTANCE) * pow(1.0 - facing, 5.0);
    let reflected = reflect(direction, normal);
    // Sky over the houses opposite, their walls below it.
    let edge = max(below_roof, 0.0) / STREET_M;
    let sky_part = smoothstep(edge - 0.08, edge + 0.08, reflected.z / max(length(reflected.xy), 1.0e-3));
    let wall = 0.35 / PI * sky_irradiance(-vec3<f32>(reflected.xy, 0.0)) * vec3<f32>(1.0, 0.96, 0.90);
    var radiance = mix(wall, sky_colour(normalize(vec3<f32>(reflected.xy, max(reflected.z, 0.0)))), sky_part);
    if received.sun {
        let half_way = normalize(frame.sun.xyz - direction);
        let gloss = (GLASS_GLOSS + 2.0) / (8.0 * PI) * pow(max(dot(normal, half_way), 0.0), GLASS_GLOSS);
        radiance += min(frame.sun_irradiance.xyz * gloss, vec3<f32>(400.0));
    }
    return Mirrored(reflectance * radiance, 1.0 - reflectance);
}

// Reflectance of the land beyond the survey, for cities with imagery.
const LAND: vec3<f32> = vec3<f32>(0.22, 0.225, 0.12);

// What is seen past the city: the sky, and below the horizon land at the city's lowest ground that runs on into the haze.
fn beyond(direction: vec3<f32>) -> vec3<f32> {
    if direction.z >= 0.0 || frame.min_ground >= 0.0 { return sky_colour(direction) + sun_disc(direction); }
    let up = vec3<f32>(0.0, 0.0, 1.0);
    let land = select(PAPER, LAND, frame.imagery_side > 0.0);
    let light = sky_irradiance(up) + frame.sun_irradiance.xyz * max(frame.sun.z, 0.0);
    return through_haze(land / PI * light, direction, frame.min_ground / direction.z);
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
        return Shaded(vec4<f32>(beyond(direction), 1.0), FAR, 0u);
    }
    let at = direction * t;
    let is_ground = t_ground <= t_relief;
    let pixel_m = t * frame.pixel_angle;
    var id = 0u;
    var normal: vec3<f32>;
    var material: Material;
    var below_roof = 0.0;
    if !is_ground {
        id = relief.y;
        normal = unpack_normal(relief.w);
        let facade = textureLoad(relief_facade, pixel, 0);
        let place = bitcast<vec3<f32>>(facade.xyz);
        if normal.z > 0.5 {
            // Counted from the eye's tile, so that it stays where it is.
            let plan = fract((frame.eye_in_tile + at.xy) / frame.tile_m) * frame.tile_m;
            material = roof_material(facade.w, id, plan, direction, pixel_m);
            let seen = imagery_at(at.xy, t, abs(direction.z));
            material.albedo = mix(material.albedo, seen.rgb, seen.a);
            material.normal = mix(material.normal, normal, seen.a);
        } else {
            let above_base = at.z - place.y;
            below_roof = place.z - above_base;
            let wall = WallPosition(bitcast<f32>(relief.z), place.x, above_base, place.z);
            material = wall_material(facade.w, id, wall, normal, direction, pixel_m);
        }
    } else {
        normal = unpack_normal(textureLoad(ground_normal, pixel, 0).x);
        let seen = imagery_at(at.xy, t, abs(dot(direction, normal)));
        let albedo = mix(bare_ground(at.z + frame.eye_elevation, normal, direction, pixel_m), seen.rgb, seen.a);
        material = Material(albedo, normal, 0.0, 0.0);
    }
    let random = sample_numbers(pixel, frame.sample);
    let start = lifted(at, normal, is_ground);
    // The sky's half, cosine-weighted, and the sun's disc.
    let azimuth = 2.0 * PI * random.y;
    let to_sky = around(normal, sqrt(random.x), azimuth);
    let to_sun = around(frame.sun.xyz, frame.sun.w * sqrt(random.z), azimuth);
    let received = receive(start, normal, to_sky, to_sun);
    let sky = ambient(material.normal, received.sky);
    let sunlight = frame.sun_irradiance.xyz * max(dot(material.normal, to_sun), 0.0);
    let sun = select(vec3<f32>(0.0), sunlight, received.sun);
    var radiance = material.albedo / PI * (sun + sky);
    if material.glass > 0.0 {
        let pane = mirrored(direction, material.normal, below_roof, received);
        // Curtains glow.
        let lamp = LAMP * material.lit * night() * clamp(0.5 + 8.0 * material.albedo.g, 0.5, 1.6);
        radiance = mix(radiance, pane.radiance + pane.passes * (radiance + lamp), material.glass);
    }
    return Shaded(vec4<f32>(through_haze(radiance, direction, t), 1.0), t, id);
}
