// A clear sky and the haze before distant things. Plausible, not physical: a gradient from zenith to horizon that
// reddens with a low sun, and a glow round the sun; an atmosphere model can take its place.

// Way through the haze on the ground that dims contrast to 1/e; the haze thins to 1/e over this height above the lowest ground.
const HAZE_RANGE_M: f32 = 22000.0;
const HAZE_HEIGHT_M: f32 = 1200.0;

fn day(sun_up: f32) -> f32 { return smoothstep(-0.12, 0.25, sun_up); }

// Irradiance of the sun on a surface facing it, relative to a high sun's white = 3.
fn sun_colour() -> vec3<f32> {
    let up = frame.sun.z;
    let warm = mix(vec3<f32>(3.2, 1.35, 0.45), vec3<f32>(3.05, 2.85, 2.5), smoothstep(0.0, 0.45, up));
    return warm * smoothstep(-0.02, 0.08, up);
}

fn sky_colour(direction: vec3<f32>) -> vec3<f32> {
    let up = max(direction.z, 0.0);
    let light = day(frame.sun.z);
    let low_sun = 1.0 - smoothstep(0.02, 0.4, frame.sun.z);
    let horizon = mix(vec3<f32>(0.72, 0.82, 0.92), vec3<f32>(1.05, 0.72, 0.48), 0.75 * low_sun);
    let zenith = mix(vec3<f32>(0.13, 0.30, 0.68), vec3<f32>(0.17, 0.24, 0.48), low_sun);
    let towards_sun = max(dot(direction, frame.sun.xyz), 0.0);
    let glow = sun_colour() * (0.12 * pow(towards_sun, 6.0) + 0.25 * pow(towards_sun, 48.0));
    let night = vec3<f32>(0.006, 0.008, 0.014);
    return night + light * (mix(horizon, zenith, 1.0 - exp(-3.2 * up)) + glow);
}

// The sun's disc, seen directly: half an angle of 0.265 degrees.
fn sun_disc(direction: vec3<f32>) -> vec3<f32> {
    let edge = smoothstep(0.999985, 0.999991, dot(direction, frame.sun.xyz));
    return sun_colour() * 60.0 * edge * step(0.0, direction.z);
}

// Mean light of the sky's half above a surface.
fn ambient_light(normal: vec3<f32>) -> vec3<f32> {
    let light = 0.03 + day(frame.sun.z);
    let sky = vec3<f32>(0.52, 0.61, 0.76);
    let ground = vec3<f32>(0.34, 0.31, 0.26);
    return light * mix(ground, sky, 0.5 + 0.5 * normal.z) * 0.95;
}

// Optical depth of the haze between the eye and a place: its density falls off exponentially with height above the lowest
// ground, and the integral along a ray has a closed form.
fn haze_depth(direction: vec3<f32>, t: f32) -> f32 {
    let eye_height = max(-frame.lowest_ground, 0.0) / HAZE_HEIGHT_M;
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
