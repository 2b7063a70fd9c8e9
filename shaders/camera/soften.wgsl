// Ghosts of a point of light made those of a disc: a ghost's light moves over the sensor as the light's direction changes, so that
// a disc of directions gives each of its points a disc (src/camera/flare/ghost/softness.rs). Host:
// src/camera/flare/draw/soft_levels.rs.

// Ghosts of a point, in texels as large as those drawn on, with a margin round them.
@group(0) @binding(0) var ghosts: texture_2d<f32>;

struct Softened {
    @builtin(position) clip: vec4<f32>,
    // Texels.
    @location(0) @interpolate(flat) radius: f32,
    // That the target lacks.
    @location(1) @interpolate(flat) margin: i32,
}

// The instance's number has the radius in its low half, 1 / 256 texels, and above it the margin.
@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Softened {
    let clip = vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
    return Softened(clip, f32(instance & 0xffffu) / 256.0, i32(instance >> 16u));
}

@fragment
fn fs(in: Softened) -> @location(0) vec4<f32> {
    let centre = vec2<i32>(in.clip.xy) + in.margin;
    let extent = i32(ceil(in.radius + 0.5)) - 1;
    var light = vec3<f32>(0.0);
    var whole = 0.0;
    for (var y = -extent; y <= extent; y++) {
        for (var x = -extent; x <= extent; x++) {
            let offset = vec2<i32>(x, y);
            let weight = clamp(in.radius + 0.5 - length(vec2<f32>(offset)), 0.0, 1.0);
            if weight > 0.0 {
                // Sums that a half float does not hold are the largest that it does.
                light += weight * min(textureLoad(ghosts, centre + offset, 0).rgb, vec3<f32>(60000.0));
                whole += weight;
            }
        }
    }
    return vec4<f32>(light / whole, 0.0);
}
