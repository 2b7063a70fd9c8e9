// Adds one sample's radiance to the sum of those before.

@group(0) @binding(0) var sum_before: texture_2d<f32>;
@group(0) @binding(1) var radiance: texture_2d<f32>;

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    return textureLoad(sum_before, pixel, 0) + textureLoad(radiance, pixel, 0);
}
