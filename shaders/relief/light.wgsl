// Lights what the passes before found: imagery on ground and roofs, facades on walls, the sun past buildings and hills, the sky as far as
// the ambient pass saw it. A sample of a pixel sends one ray to a point of the sun's disc: many samples converge, and a single one has
// the same mean, only noisier.

@group(2) @binding(0) var ground_distance: texture_2d<f32>;
@group(2) @binding(1) var ground_normal: texture_2d<u32>;
// `BuildingTexels`.
@group(2) @binding(2) var relief_surface: texture_2d<u32>;
@group(2) @binding(3) var relief_facade: texture_2d<u32>;
@group(2) @binding(4) var imagery: texture_2d_array<f32>;
@group(2) @binding(5) var imagery_sampler: sampler;
// What `ambient.wgsl` wrote.
@group(2) @binding(11) var ambient_rays: texture_2d<u32>;

struct Shaded {
    // Linear radiance.
    @location(0) radiance: vec4<f32>,
    // Metres along the view ray, FAR for sky.
    @location(1) distance: f32,
    @location(2) id: u32,
}

// Imagery at a place.
struct Imagery {
    // Linear; alpha 0 where there is none.
    colour: vec4<f32>,
    // Its texels in a pixel: fewer than one where it is enlarged.
    texels: f32,
}

// Imagery at an eye-relative position. `size`: of a pixel on the surface, metres.
fn imagery_at(plan: vec2<f32>, size: f32) -> Imagery {
    let tile = frame.eye_tile + vec2<i32>(floor((frame.eye_in_tile + plan) / frame.tile_m));
    let entry = imagery_entry(tile);
    if entry.slot < 0 { return Imagery(vec4<f32>(0.0), 1.0); }
    let tile_m = level_tile_m(entry.level);
    let uv = (plan - tile_corner(tile_over(tile, entry.level))) / tile_m;
    let texels = size * frame.imagery_side / tile_m;
    let colour = textureSampleLevel(imagery, imagery_sampler, vec2<f32>(uv.x, 1.0 - uv.y), entry.slot, log2(max(texels, 1.0)));
    return Imagery(colour, texels);
}

// Width of a pixel on a surface that the ray meets with the cosine `facing`, metres: between that across and that along the ray.
fn pixel_size(pixel_m: f32, facing: f32) -> f32 { return pixel_m / sqrt(max(abs(facing), 0.05)); }

// Places counted from the city's corner, so that they stay where they are and run on over the tiles.
fn plan_of(at: vec2<f32>) -> vec2<f32> { return vec2<f32>(frame.eye_tile) * frame.tile_m + frame.eye_in_tile + at; }

// How much of bare ground's grain enlarged imagery gets.
const ENLARGED_GRAIN: f32 = 0.6;

// What the ground before a wall gets of the open ground's light, for the shadows on it. An estimate.
const GROUND_OPEN: f32 = 0.75;

// The parts of the light from all round by where it comes from (`MEETS_GROUND` and so on): of the rays that the ambient pass cast
// for the four nearest of its pixels, those that left the same surface. On an edge that none of them saw, the likest.
fn light_parts(pixel: vec2<i32>, at: vec3<f32>, normal: vec3<f32>) -> vec4<f32> {
    let own = pixel >> vec2<u32>(1u);
    // Sideways to the nearer one; upwards always, because the one below may be of a band that is not drawn yet.
    let beside = vec2<i32>(select(-1, 1, (pixel.x & 1) == 1), -1);
    let last = (vec2<i32>(frame.size) - 1) >> vec2<u32>(1u);
    let tolerance = 0.02 + 2.0 * length(at) * frame.pixel_angle;
    var parts = vec4<f32>(0.0, 0.0, 1.0e-6, 0.0);
    for (var k = 0; k < 4; k += 1) {
        let place = clamp(own + beside * vec2<i32>(k & 1, k >> 1u), vec2<i32>(0), last);
        let word = textureLoad(ambient_rays, place, 0);
        if word.y == NO_SURFACE { continue; }
        let surface = unpack_normal(word.y);
        let t = bitcast<f32>(word.x & ~3u);
        let from_at = ray_direction(vec2<f32>(sampled_pixel(place)) + 0.5) * t;
        let is_same = dot(surface, normal) > 0.9 && abs(dot(from_at - at, normal)) < tolerance;
        let weight = select(0.001 * (1.01 + dot(surface, normal)), 1.0, is_same);
        parts[word.x & 3u] += weight;
    }
    return parts / dot(parts, vec4<f32>(1.0));
}

// Irradiance from all round.
fn ambient(normal: vec3<f32>, parts: vec4<f32>) -> vec3<f32> {
    let open = parts[MEETS_SKY] + GROUND_OPEN * parts[MEETS_GROUND];
    let walls = parts[MEETS_WALL] * wall_light(false) + parts[MEETS_SUNNY_WALL] * wall_light(true);
    return open * sky_irradiance(normal) + walls + (parts[MEETS_WALL] + parts[MEETS_SUNNY_WALL]) * PI * NIGHT_SKY;
}

// Walls and roofs without facades: plaster.
const PLASTER: vec3<f32> = vec3<f32>(0.62, 0.605, 0.575);

fn plaster(normal: vec3<f32>) -> Material { return Material(PLASTER, normal, 0.0, 0.0); }

fn hides_facades() -> bool { return (frame.hidden & HIDES_FACADES) != 0u; }

// Whether the sun is seen along a ray, past buildings and the ground.
fn sees_sun(start: vec3<f32>, normal: vec3<f32>, to_sun: vec3<f32>) -> bool {
    if to_sun.z <= 0.0 || dot(normal, to_sun) <= 0.0 { return false; }
    let ray = make_ray(start, to_sun);
    let end = clear_from(start, to_sun);
    if end <= 0.0 { return true; }
    if walk_city(ray, 0.0, end).t < FAR { return false; }
    return walk_ground(ray, 0.0, end) >= FAR;
}

// Reflectance of a pane at normal incidence: two surfaces of index 1.52, of 0.0426 each, with what goes to and fro between them;
// exponent of its gloss.
const GLASS_REFLECTANCE: f32 = 0.0817;
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

fn mirrored(direction: vec3<f32>, normal: vec3<f32>, below_roof: f32, in_sun: bool) -> Mirrored {
    let facing = clamp(-dot(direction, normal), 0.0, 1.0);
    let reflectance = GLASS_REFLECTANCE + (1.0 - GLASS_REFLECTANCE) * pow(1.0 - facing, 5.0);
    let reflected = reflect(direction, normal);
    // Sky over the houses opposite, their walls below it.
    let edge = max(below_roof, 0.0) / STREET_M;
    let sky_part = smoothstep(edge - 0.08, edge + 0.08, reflected.z / max(length(reflected.xy), 1.0e-3));
    let wall = wall_light(faces_sun(reflected)) / PI;
    var radiance = mix(wall, sky_colour(above_horizon(reflected)), sky_part);
    if in_sun {
        let half_way = normalize(frame.sun.xyz - direction);
        let gloss = (GLASS_GLOSS + 2.0) / (8.0 * PI) * pow(max(dot(normal, half_way), 0.0), GLASS_GLOSS);
        radiance += min(frame.sun_irradiance.xyz * gloss, vec3<f32>(400.0));
    }
    return Mirrored(reflectance * radiance, 1.0 - reflectance);
}

// Reflectance of the land beyond the survey, for cities with imagery.
const LAND: vec3<f32> = vec3<f32>(0.22, 0.225, 0.12);

fn has_orthophotos() -> bool { return frame.wall_light.w > 0.0; }

// Whether a ray that leaves the city goes to the sky: below the horizon land lies at the city's lowest ground.
fn meets_sky(direction: vec3<f32>) -> bool { return direction.z >= 0.0 || frame.min_ground >= 0.0; }

// What is seen past the city: the sky, and land that runs on into the haze.
fn beyond(direction: vec3<f32>, air: vec3<f32>) -> vec3<f32> {
    if meets_sky(direction) { return air + sun_disc(direction); }
    let up = vec3<f32>(0.0, 0.0, 1.0);
    let t = frame.min_ground / direction.z;
    let size = pixel_size(t * frame.pixel_angle, direction.z);
    let land = select(open_land(plan_of(t * direction.xy), size), LAND, has_orthophotos());
    let light = sky_irradiance(up) + frame.sun_irradiance.xyz * max(frame.sun.z, 0.0);
    return through_air(land / PI * light, air, direction, t);
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> Shaded {
    let pixel = vec2<i32>(position.xy);
    let direction = ray_direction(position.xy);
    let t_ground = textureLoad(ground_distance, pixel, 0).x;
    let relief = textureLoad(relief_surface, pixel, 0);
    let t_relief = bitcast<f32>(relief.x);
    let t = min(t_ground, t_relief);
    let air = air_before(direction, t >= FAR && meets_sky(direction));
    if t >= FAR { return Shaded(vec4<f32>(beyond(direction, air), 1.0), FAR, 0u); }
    let at = direction * t;
    let plan = plan_of(at.xy);
    let is_ground = t_ground <= t_relief;
    let normal = unpack_normal(select(relief.w, textureLoad(ground_normal, pixel, 0).x, is_ground));
    let is_wall = !is_ground && normal.z <= 0.5;
    let pixel_m = t * frame.pixel_angle;
    let size = pixel_size(pixel_m, dot(direction, normal));
    let id = select(relief.y, 0u, is_ground);
    let facade = textureLoad(relief_facade, pixel, 0);
    let code = facade.w;
    let place = bitcast<vec3<f32>>(facade.xyz);
    let above_base = at.z - place.y;
    let slope = roof_slope(code, at.xy, direction, select(0u, relief.z, !is_ground && !is_wall), size);
    // One read of the tiles, whatever the surface: a software device pays for all sides of a branch.
    var tile: WallTile;
    if is_wall {
        tile = wall_tile(code, id, WallPosition(bitcast<f32>(relief.z), place.x, above_base, place.z), normal, direction, pixel_m);
    } else if is_ground {
        tile.place = ground_tile(plan, size);
    } else {
        tile.place = roof_tile(code, roofing_position(slope, code, plan), size);
    }
    let texel = tile_texel(tile.place);
    var material: Material;
    if is_wall {
        material = under_eaves(wall_material(code, id, normal, texel, tile), code, place.z - above_base, place.z, pixel_m / max(length(direction.xy), 0.02));
    } else {
        let seen = imagery_at(at.xy, size);
        if is_ground {
            // Imagery that is none of orthophotos is a plan of streets.
            let has_plan = frame.imagery_side > 0.0 && !has_orthophotos() && (frame.hidden & HIDES_IMAGERY) == 0u;
            let ground = GroundView(at.xy, plan, at.z + frame.eye_elevation, normal, -dot(direction, normal), size);
            let bare = bare_ground(ground, texel, has_plan);
            // Where the imagery tells no more.
            let enlarged = 1.0 - smoothstep(0.25, 1.0, seen.texels);
            let photographed = seen.colour.rgb * mix(1.0, bare.lightness, ENLARGED_GRAIN * enlarged);
            let shown = min(seen.colour.a / 0.87, 1.0);
            let relief_normal = normalize(mix(bare.normal, normal, shown));
            material = Material(mix(bare.albedo, photographed, shown), relief_normal, 0.0, 0.0);
        } else {
            material = with_slope(roof_material(roof_direction(slope, code), id, texel), slope, size);
            if is_flat_roof(code) { material = with_parapet(material, id, at.xy, pixel_m); }
            if hides_facades() { material = plaster(normal); }
            // Not the plan that is drawn on the ground, which is less opaque (`ground_plan.rs`).
            let shows_roof = smoothstep(0.92, 0.98, seen.colour.a);
            material.albedo = mix(material.albedo, seen.colour.rgb, shows_roof);
            material.normal = mix(material.normal, normal, shows_roof);
        }
    }
    if is_wall && hides_facades() { material = plaster(normal); }
    let random = sample_numbers(pixel, frame.sample);
    let start = lifted(at, normal, is_ground);
    let to_sun = around(frame.sun.xyz, frame.sun.w * sqrt(random.z), 2.0 * PI * random.y);
    let in_sun = sees_sun(start, normal, to_sun);
    let sky = ambient(material.normal, light_parts(pixel, at, normal));
    let sunlight = frame.sun_irradiance.xyz * max(dot(material.normal, to_sun), 0.0);
    let sun = select(vec3<f32>(0.0), sunlight, in_sun);
    var radiance = material.albedo / PI * (sun + sky);
    if material.glass > 0.0 {
        let pane = mirrored(direction, material.normal, place.z - above_base, in_sun);
        let lamp = LAMP * material.lit * night();
        radiance = mix(radiance, pane.radiance + pane.passes * (radiance + lamp), material.glass);
    }
    return Shaded(vec4<f32>(through_air(radiance, air, direction, t), 1.0), t, id);
}
