// The clear sky and the air before distant things: Hillaire 2020, whose tables the host makes for the sun of the frame
// (src/space/atmosphere, src/relief/sky_tables.rs).

const PI: f32 = 3.14159265;

// Layer 0: light scattered by molecules, more than once, or sent on by the ground. Layer 1: light scattered once by haze, to be
// multiplied by its phase function. Along u the azimuth from the sun's, along v the altitude.
@group(2) @binding(10) var sky_view: texture_2d_array<f32>;

// Air near the ground, per metre: what it takes of light by scattering (Rayleigh) and haze. It thins to 1/e over this height above
// the lowest ground.
const AIR_PER_M: vec3<f32> = vec3<f32>(5.802e-6, 13.558e-6, 33.1e-6) + HAZE_PER_M;
const HAZE_HEIGHT_M: f32 = 1200.0;
// After so much of it, metres, it hides twice as much, and more and more from there on: land goes over to the sky before the horizon. An
// estimate.
const HORIZON_M: f32 = 4500.0;

// Radiance of the sky at night, and irradiance: stars and air, and the lamps of towns. Estimates.
const NIGHT_SKY: vec3<f32> = vec3<f32>(0.00032, 0.00042, 0.00080);

// How far day has gone over to night: lamps are lit.
fn night() -> f32 { return 1.0 - smoothstep(-0.10, 0.03, frame.sun.z); }

// Twin: `place_of` in src/space/atmosphere/sky_view.rs.
fn sky_place(altitude: f32) -> f32 { return 0.5 + 0.5 * sign(altitude) * sqrt(abs(altitude) / (0.5 * PI)); }

// Phase function of haze (Cornette & Shanks 1992).
fn mie_phase(cosine: f32) -> f32 {
    let g2 = MIE_G * MIE_G;
    let scale = 3.0 / (8.0 * PI) * (1.0 - g2) / (2.0 + g2);
    return scale * (1.0 + cosine * cosine) / pow(1.0 + g2 - 2.0 * MIE_G * cosine, 1.5);
}

// Radiance of a unit direction, the sun's disc left out; below the horizon the planet's through the air before it.
fn sky_colour(direction: vec3<f32>) -> vec3<f32> { return air_colour(direction, direction); }

// What the air of the sky in a unit direction sends on by `towards`, a direction of the same azimuth.
fn air_colour(direction: vec3<f32>, towards: vec3<f32>) -> vec3<f32> {
    let size = vec2<f32>(textureDimensions(sky_view));
    let across = length(direction.xy) * length(frame.sun.xy);
    let cosine = select(1.0, dot(direction.xy, frame.sun.xy) / across, across > 1.0e-7);
    let place = vec2<f32>(acos(clamp(cosine, -1.0, 1.0)) / PI, sky_place(asin(clamp(direction.z, -1.0, 1.0))));
    // Texel centres lie on the ends.
    let uv = (place * (size - 1.0) + 0.5) / size;
    let even = textureSampleLevel(sky_view, imagery_sampler, uv, 0, 0.0).rgb;
    let haze = textureSampleLevel(sky_view, imagery_sampler, uv, 1, 0.0).rgb;
    return NIGHT_SKY + even + haze * mie_phase(dot(towards, frame.sun.xyz));
}

// A direction, or the horizon under it; of one straight down any.
fn above_horizon(direction: vec3<f32>) -> vec3<f32> {
    return normalize(vec3<f32>(direction.x + 1.0e-6, direction.y, max(direction.z, 0.0)));
}

// The sun's disc, seen directly: its irradiance spread over its solid angle, less what a lens spreads round it.
fn sun_disc(direction: vec3<f32>) -> vec3<f32> {
    let radius = frame.sun.w;
    // By the chord, which keeps its digits where a cosine has none left.
    let is_on_disc = distance(direction, frame.sun.xyz) < radius && direction.z > 0.0;
    // What a half float holds.
    let radiance = min(frame.sun_irradiance.xyz * frame.sun_irradiance.w / (PI * radius * radius), vec3<f32>(65000.0));
    return select(vec3<f32>(0.0), radiance, is_on_disc);
}

// Irradiance on a surface that sees the whole sky above it and open ground below. Twin: `SkyIrradiance::on`.
fn sky_irradiance(normal: vec3<f32>) -> vec3<f32> {
    let towards = frame.sun.xy / max(length(frame.sun.xy), 1.0e-6);
    let n = vec3<f32>(dot(normal.xy, towards), dot(normal.xy, vec2<f32>(-towards.y, towards.x)), normal.z);
    let c = frame.sky_light;
    let light = c[0].rgb + c[1].rgb * n.y + c[2].rgb * n.z + c[3].rgb * n.x + c[4].rgb * (n.x * n.y) + c[5].rgb * (n.y * n.z)
        + c[6].rgb * (3.0 * n.z * n.z - 1.0) + c[7].rgb * (n.x * n.z) + c[8].rgb * (n.x * n.x - n.y * n.y);
    return max(light, vec3<f32>(0.0)) + PI * NIGHT_SKY;
}

// Depth of the air between the eye and a place, metres of that near the ground: its density falls off exponentially with height above
// the lowest ground, and the integral along a ray has a closed form.
fn air_depth(direction: vec3<f32>, t: f32) -> f32 {
    let eye_height = max(-frame.min_ground, 0.0) / HAZE_HEIGHT_M;
    let rise = t * direction.z / HAZE_HEIGHT_M;
    let at_eye = exp(-eye_height);
    // The mean density along the ray, by its series where that is nearly level.
    let mean = select((at_eye - exp(-eye_height - rise)) / rise, at_eye * (1.0 - 0.5 * rise), abs(rise) < 0.01);
    return t * mean;
}

// The light of the air in a direction: the sky's own, or before a surface that of the sky at the horizon, whose haze sends on less of a
// low sun's the steeper one looks down.
fn air_before(direction: vec3<f32>, is_sky: bool) -> vec3<f32> {
    return air_colour(select(above_horizon(direction), direction, is_sky), direction);
}

// What is seen of a radiance at t through air of a colour.
fn through_air(colour: vec3<f32>, air: vec3<f32>, direction: vec3<f32>, t: f32) -> vec3<f32> {
    let depth = air_depth(direction, t);
    let away = depth / HORIZON_M;
    return mix(air, colour, exp(-AIR_PER_M * (1.0 + away * away) * depth));
}
