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
    // A quarter of the disc, turned by right angles: the four weigh the same.
    var light = ghost(centre);
    var whole = 1.0;
    for (var y = 0; y <= extent; y++) {
        for (var x = 1; x <= extent; x++) {
            let weight = clamp(in.radius + 0.5 - length(vec2<f32>(f32(x), f32(y))), 0.0, 1.0);
            if weight == 0.0 { break; }
            let across = vec2<i32>(x, y);
            let along = vec2<i32>(-y, x);
            light += weight * (ghost(centre + across) + ghost(centre - across) + ghost(centre + along) + ghost(centre - along));
            whole += 4.0 * weight;
        }
    }
    return vec4<f32>(light / whole, 0.0);
}

fn ghost(at: vec2<i32>) -> vec3<f32> {
    // Sums that a half float does not hold are the largest that it does.
    return min(textureLoad(ghosts, at, 0).rgb, vec3<f32>(60000.0));
}
