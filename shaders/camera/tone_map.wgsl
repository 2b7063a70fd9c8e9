// Exposure and tone mapping to the display, by the curve of shaders/lib/tone_curve.wgsl.

struct Exposure {
    // Factor from summed radiance to the display's linear 0..1.
    scale: f32,
    // Factor of the flare, which is no sum.
    flare_scale: f32,
    padding: vec2<f32>,
}

@group(0) @binding(0) var sum: texture_2d<f32>;
@group(0) @binding(1) var<uniform> exposure: Exposure;
@group(0) @binding(2) var flare: texture_2d<f32>;

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let colour = textureLoad(sum, pixel, 0).rgb * exposure.scale + textureLoad(flare, pixel, 0).rgb * exposure.flare_scale;
    return vec4<f32>(tone_curve(colour), 1.0);
}
