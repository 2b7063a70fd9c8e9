// The city's image over the whole window, whatever its size. Host: src/viewer/blit.rs.

@group(0) @binding(0) var image: texture_2d<f32>;
@group(0) @binding(1) var image_sampler: sampler;
// Pixels of the window.
@group(0) @binding(2) var<uniform> window: vec4<f32>;

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return textureSampleLevel(image, image_sampler, position.xy / window.xy, 0.0);
}
