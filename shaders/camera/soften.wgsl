// Ghosts of a point of light made those of a disc: a ghost's light moves over the sensor as the light's direction changes, so that
// a disc of directions gives each of its points a disc (src/camera/flare/ghost/softness.rs). Host:
// src/camera/flare/draw/soft_levels.rs.

// Ghosts of a point, in texels as large as those drawn on or half as large, with a margin round them.
@group(0) @binding(0) var ghosts: texture_2d<f32>;
@group(0) @binding(1) var ghosts_sampler: sampler;

struct Softened {
    @builtin(position) clip: vec4<f32>,
    // Texels drawn on.
    @location(0) @interpolate(flat) radius: f32,
    @location(1) @interpolate(flat) margin: i32,
    @location(2) @interpolate(flat) size: vec2<f32>,
    @location(3) @interpolate(flat) halves: f32,
}

// The instance's number has the radius in its low half, 1 / 256 texels; above it the margin that the target lacks, and in its
// highest bit whether the ghosts' texels are half as large.
@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Softened {
    let clip = vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    let radius = f32(instance & 0xffffu) / 256.0;
    let halves = select(1.0, 0.5, (instance >> 31u) == 1u);
    let margin = i32((instance >> 16u) & 0x7fffu);
    return Softened(clip, radius, margin, vec2<f32>(textureDimensions(ghosts)) * halves, halves);
}

@fragment
fn fs(in: Softened) -> @location(0) vec4<f32> {
    let centre = floor(in.clip.xy) + f32(in.margin) + 0.5;
    let extent = i32(ceil(in.radius + 0.5)) - 1;
    var light = vec3<f32>(0.0);
    var whole = 0.0;
    for (var y = -extent; y <= extent; y++) {
        for (var x = -extent; x <= extent; x++) {
            let offset = vec2<f32>(f32(x), f32(y));
            let weight = clamp(in.radius + 0.5 - length(offset), 0.0, 1.0);
            if weight > 0.0 {
                let at = centre + offset;
                var found = vec3<f32>(0.0);
                if in.halves < 1.0 {
                    found = textureSampleLevel(ghosts, ghosts_sampler, at / in.size, 0.0).rgb;
                } else {
                    found = textureLoad(ghosts, vec2<i32>(at), 0).rgb;
                }
                // Sums that a half float does not hold are the largest that it does.
                light += weight * min(found, vec3<f32>(60000.0));
                whole += weight;
            }
        }
    }
    return vec4<f32>(light / whole, 0.0);
}
