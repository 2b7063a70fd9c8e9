// The part of an image's flare that a window shows, enlarged where the flare has fewer pixels than the image.
// Host: src/output/flare_window.rs.

struct FlareWindow {
    // The window's first pixel in the image.
    first: vec2<f32>,
    // The flare's texels a pixel of the image.
    texels: vec2<f32>,
}

@group(0) @binding(0) var<uniform> window: FlareWindow;
@group(0) @binding(1) var flare: texture_2d<f32>;

// What a half float holds: sums that went beyond it could not be blended.
fn texel(place: vec2<i32>) -> vec3<f32> {
    let last = vec2<i32>(textureDimensions(flare)) - 1;
    return min(textureLoad(flare, clamp(place, vec2<i32>(0), last), 0).rgb, vec3<f32>(65504.0));
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = (position.xy + window.first) * window.texels - 0.5;
    let place = vec2<i32>(floor(at));
    let part = at - floor(at);
    let upper = mix(texel(place), texel(place + vec2<i32>(1, 0)), part.x);
    let lower = mix(texel(place + vec2<i32>(0, 1)), texel(place + vec2<i32>(1, 1)), part.x);
    return vec4<f32>(mix(upper, lower, part.y), 0.0);
}
