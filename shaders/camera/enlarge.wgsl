// Softened ghosts of one size of texel added to those of half that size, or to the image. Host:
// src/camera/flare/draw/soft_levels.rs.

@group(0) @binding(0) var coarse: texture_2d<f32>;
@group(0) @binding(1) var coarse_sampler: sampler;

struct Enlarged {
    @builtin(position) clip: vec4<f32>,
    // Margin of the target, texels.
    @location(0) @interpolate(flat) margin: f32,
}

// The instance's number is the margin.
@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Enlarged {
    let clip = vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    return Enlarged(clip, f32(instance));
}

@fragment
fn fs(in: Enlarged) -> @location(0) vec4<f32> {
    let at = 0.5 * (in.clip.xy - in.margin) + SOFT_MARGIN;
    return vec4<f32>(textureSampleLevel(coarse, coarse_sampler, at / vec2<f32>(textureDimensions(coarse)), 0.0).rgb, 0.0);
}
