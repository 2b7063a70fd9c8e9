// Vignetting, exposure and tone mapping to the display, by the curve of shaders/lib/tone_curve.wgsl.

struct Exposure {
    // Factor from summed radiance to the display's linear 0..1.
    scale: f32,
    // Factor of the flare, which is no sum, and of which the lens has taken what it takes.
    flare_scale: f32,
    // The image's centre, pixels from the first one drawn.
    centre: vec2<f32>,
    // Factors of the channels on top of either.
    white_balance: vec3<f32>,
    // Places of the falloff a pixel from the centre; none without a lens.
    places_per_pixel: f32,
    // Part of the light at equal distances from the centre to the sensor's corner (src/camera/vignetting.rs).
    falloff: array<vec4<f32>, 4>,
}

@group(0) @binding(0) var sum: texture_2d<f32>;
@group(0) @binding(1) var<uniform> exposure: Exposure;
@group(0) @binding(2) var flare: texture_2d<f32>;

fn falloff_at(place: i32) -> f32 {
    return exposure.falloff[place / 4][place % 4];
}

// Twin: `Vignetting::at`.
fn vignetting(position: vec2<f32>) -> f32 {
    let place = min(distance(position, exposure.centre) * exposure.places_per_pixel, FALLOFF_PLACES - 1.0);
    let below = min(i32(place), i32(FALLOFF_PLACES) - 2);
    return mix(falloff_at(below), falloff_at(below + 1), place - f32(below));
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let city = textureLoad(sum, pixel, 0).rgb * exposure.scale * vignetting(position.xy);
    let colour = city + textureLoad(flare, pixel, 0).rgb * exposure.flare_scale;
    return vec4<f32>(tone_curve(colour * exposure.white_balance), 1.0);
}
