// Ghosts on texels of one size added to those on texels half or twice as large, or to the image. Host:
// src/camera/flare/draw/soft_levels.rs.

@group(0) @binding(0) var ghosts: texture_2d<f32>;
@group(0) @binding(1) var ghosts_sampler: sampler;

struct Resampled {
    @builtin(position) clip: vec4<f32>,
    // Of a texel drawn on, the texels of the ghosts, and where those begin.
    @location(0) @interpolate(flat) scale: f32,
    @location(1) @interpolate(flat) start: f32,
}

// The instance's number is the margin of a target of smaller texels; in its highest bit whether they are larger.
@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Resampled {
    let clip = vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    if (instance >> 31u) == 1u {
        return Resampled(clip, 2.0, 0.0);
    }
    return Resampled(clip, 0.5, SOFT_MARGIN - 0.5 * f32(instance));
}

@fragment
fn fs(in: Resampled) -> @location(0) vec4<f32> {
    let at = (in.start + in.scale * in.clip.xy) / vec2<f32>(textureDimensions(ghosts));
    let light = textureSampleLevel(ghosts, ghosts_sampler, at, 0.0).rgb;
    // Sums that a half float does not hold are the largest that it does.
    return vec4<f32>(min(light, vec3<f32>(60000.0)), 0.0);
}
