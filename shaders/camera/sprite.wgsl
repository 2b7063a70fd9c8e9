// An image that lies on the film, added to the radiance: the sun with its starburst, or a recorded flare.
// Host: src/camera/flare/draw/sprite_layer.rs.

struct SpriteFrame {
    // Its centre and half its size before the rotation, millimetres of the sensor, x right and y up.
    centre_mm: vec2<f32>,
    half_mm: vec2<f32>,
    // Cosine and sine of its rotation about the centre of the film.
    rotation: vec2<f32>,
    // Half the image that is drawn on, millimetres.
    image_half_mm: vec2<f32>,
    // Factor on the image's values.
    radiance: vec3<f32>,
    padding: f32,
}

@group(0) @binding(0) var<uniform> sprite: SpriteFrame;
@group(0) @binding(1) var image: texture_2d<f32>;
@group(0) @binding(2) var image_sampler: sampler;

struct SpriteVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn vs(@builtin(vertex_index) index: u32) -> SpriteVertex {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let at = sprite.centre_mm + sprite.half_mm * corner;
    let r = sprite.rotation;
    let rotated = vec2<f32>(r.x * at.x - r.y * at.y, r.y * at.x + r.x * at.y);
    // Rows of the image run from its top.
    let uv = vec2<f32>(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y);
    return SpriteVertex(vec4<f32>(rotated / sprite.image_half_mm, 0.0, 1.0), uv);
}

@fragment
fn fs(in: SpriteVertex) -> @location(0) vec4<f32> {
    // What a half float holds.
    let light = textureSample(image, image_sampler, in.uv).rgb * sprite.radiance;
    return vec4<f32>(min(light, vec3<f32>(60000.0)), 0.0);
}
