// Ghosts: triangles on the sensor, added up. Each fragment looks up the aperture where its ray crossed the stop, and is cut
// where its ray meets the lens barrel (KR 10-1465658; Lee & Eisemann 2013, section 4).

struct FlareFrame {
    // Half what the viewport shows of the sensor, and its centre, millimetres.
    half_mm: vec2<f32>,
    centre_mm: vec2<f32>,
    // Of the visible part of the light: vertices are for 1.
    irradiance: vec3<f32>,
    padding: f32,
}

@group(0) @binding(0) var<uniform> flare: FlareFrame;
@group(0) @binding(2) var aperture_sampler: sampler;

const PI: f32 = 3.14159265;

struct GhostVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) stop: vec2<f32>,
    @location(1) barrel: vec2<f32>,
    @location(2) radiance: vec3<f32>,
    @location(3) opacity: f32,
    // Where the softened aperture is among its slices, if it is softened; radius of the disc on the front.
    @location(4) @interpolate(flat) soft: vec2<f32>,
}

@vertex
fn vs(
    @location(0) sensor_mm: vec2<f32>,
    @location(1) stop: vec2<f32>,
    @location(2) barrel: vec2<f32>,
    @location(3) radiance: vec3<f32>,
    @location(4) opacity: f32,
    // Of the whole ghost: its centre, and by how much it is enlarged about that, as it is smaller than texels can show.
    @location(5) ghost_mm: vec2<f32>,
    @location(6) enlarged: vec2<f32>,
    // Radii of the discs that soften it, in radii of the iris and of the front (src/camera/flare/ghost/softness.rs).
    @location(7) soft: vec2<f32>,
) -> GhostVertex {
    let at = ghost_mm + (sensor_mm - ghost_mm) * enlarged;
    let clip = vec4<f32>((at - flare.centre_mm) / flare.half_mm, 0.0, 1.0);
    let along = log(max(soft.x, MIN_SOFTNESS) / MIN_SOFTNESS) / log(MAX_SOFTNESS / MIN_SOFTNESS);
    let slice = (0.5 + along * (SOFT_MASKS - 1.0)) / SOFT_MASKS;
    return GhostVertex(clip, stop, barrel, radiance / (enlarged.x * enlarged.y), opacity, vec2<f32>(slice, soft.y));
}

// Part of a disc on the one side of a straight edge, at a distance from its centre in radii.
fn disc_part(distance: f32) -> f32 {
    let t = clamp(distance, -1.0, 1.0);
    return 0.5 + (t * sqrt(1.0 - t * t) + asin(t)) / PI;
}

@fragment
fn fs(in: GhostVertex) -> @location(0) vec4<f32> {
    let height = length(in.barrel);
    // The barrel's edge, one pixel soft at least.
    let through = disc_part((1.0 - height) / max(in.soft.y, max(0.5 * fwidth(height), 1.0e-6)));
    let open = iris_open(in.stop, in.soft.x);
    return vec4<f32>(in.radiance * flare.irradiance * open * through, in.opacity * open * through);
}
