// The sun's own image with its starburst, added to the picture as one square (the pattern: src/camera/flare/starburst.rs).

struct StarFrame {
    // Middle and half sides of the square, normalised device coordinates.
    middle: vec2<f32>,
    half: vec2<f32>,
    // Radiance per share of light and square millimetre.
    radiance: vec3<f32>,
    padding: f32,
}

@group(0) @binding(0) var<uniform> star: StarFrame;
@group(0) @binding(1) var pattern: texture_2d<f32>;
@group(0) @binding(2) var pattern_sampler: sampler;

struct StarVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) place: vec2<f32>,
}

@vertex
fn vs(@builtin(vertex_index) index: u32) -> StarVertex {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    return StarVertex(vec4<f32>(star.middle + star.half * corner, 0.0, 1.0), 0.5 + 0.5 * corner);
}

@fragment
fn fs(in: StarVertex) -> @location(0) vec4<f32> {
    // What a half float holds.
    let light = textureSample(pattern, pattern_sampler, in.place).rgb * star.radiance;
    return vec4<f32>(min(light, vec3<f32>(60000.0)), 0.0);
}
