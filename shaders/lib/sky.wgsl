// A clear sky and the haze before distant things. Plausible, not physical: a gradient from zenith to horizon that
// reddens with a low sun, and a glow round the sun; an atmosphere model can take its place. The sun's own light comes from Rust
// (`space::Sun`).

const PI: f32 = 3.14159265;

// Path through the haze on the ground that dims contrast to 1/e; the haze thins to 1/e over this height above the lowest ground.
const HAZE_RANGE_M: f32 = 22000.0;
const HAZE_HEIGHT_M: f32 = 1200.0;

fn day(sun_up: f32) -> f32 { return smoothstep(-0.12, 0.25, sun_up); }

// The glow round the sun: its width as powers of the cosine from the sun, and its radiance by the sun's irradiance.
const WIDE_GLOW: vec2<f32> = vec2<f32>(6.0, 0.0955);
const NARROW_GLOW: vec2<f32> = vec2<f32>(48.0, 0.199);

fn sky_colour(direction: vec3<f32>) -> vec3<f32> {
    let up = max(direction.z, 0.0);
    let light = day(frame.sun.z);
    let low_sun = 1.0 - smoothstep(0.02, 0.4, frame.sun.z);
    let horizon = mix(vec3<f32>(0.72, 0.82, 0.92), vec3<f32>(1.05, 0.72, 0.48), 0.75 * low_sun);
    let zenith = mix(vec3<f32>(0.13, 0.30, 0.68), vec3<f32>(0.17, 0.24, 0.48), low_sun);
    let towards_sun = max(dot(direction, frame.sun.xyz), 0.0);
    let glow = frame.sun_irradiance.xyz
        * (WIDE_GLOW.y * pow(towards_sun, WIDE_GLOW.x) + NARROW_GLOW.y * pow(towards_sun, NARROW_GLOW.x));
    let night = vec3<f32>(0.006, 0.008, 0.014);
    return night + light * (mix(horizon, zenith, 1.0 - exp(-3.2 * up)) + glow);
}

// The sun's disc, seen directly: its irradiance spread over its solid angle.
fn sun_disc(direction: vec3<f32>) -> vec3<f32> {
    let radius = frame.sun.w;
    // By the chord, which keeps its digits where a cosine has none left.
    let is_on_disc = distance(direction, frame.sun.xyz) < radius && direction.z > 0.0;
    // What a half float holds.
    let radiance = min(frame.sun_irradiance.xyz / (PI * radius * radius), vec3<f32>(60000.0));
    return select(vec3<f32>(0.0), radiance, is_on_disc);
}

// Irradiance of the sky on a surface, all of it seen: bluish from above, the colour of lit ground from below. At night a rest
// remains, so that nothing is black.
const SKY_ABOVE: vec3<f32> = vec3<f32>(0.621, 0.728, 0.907);
const SKY_BELOW: vec3<f32> = vec3<f32>(0.406, 0.370, 0.310);
const NIGHT: f32 = 0.03;

fn sky_irradiance(normal: vec3<f32>) -> vec3<f32> {
    return (NIGHT + day(frame.sun.z)) * mix(SKY_BELOW, SKY_ABOVE, 0.5 + 0.5 * normal.z);
}

// Optical depth of the haze between the eye and a place: its density falls off exponentially with height above the lowest
// ground, and the integral along a ray has a closed form.
fn haze_depth(direction: vec3<f32>, t: f32) -> f32 {
    let eye_height = max(-frame.min_ground, 0.0) / HAZE_HEIGHT_M;
    let rise = t * direction.z / HAZE_HEIGHT_M;
    let at_eye = exp(-eye_height);
    // The mean density along the ray, by its series where that is nearly level.
    let mean = select((at_eye - exp(-eye_height - rise)) / rise, at_eye * (1.0 - 0.5 * rise), abs(rise) < 0.01);
    return t / HAZE_RANGE_M * mean;
}

fn through_haze(colour: vec3<f32>, direction: vec3<f32>, t: f32) -> vec3<f32> {
    let flat = normalize(vec3<f32>(direction.xy, max(direction.z, 0.0)));
    return mix(sky_colour(flat), colour, exp(-haze_depth(direction, t)));
}
