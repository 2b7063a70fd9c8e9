// Ghosts: triangles on the sensor, added up. Each fragment looks up the aperture where its ray crossed the stop, and is cut
// where its ray meets the lens barrel (KR 10-1465658; Lee & Eisemann 2013, section 4).

struct FlareFrame {
    // Half the image's width and height, millimetres of the sensor.
    half_mm: vec2<f32>,
    // Half the side of the aperture's mask, in radii of the stop.
    mask_extent: f32,
    padding_a: f32,
    // Of the visible part of the light: vertices are for 1.
    irradiance: vec3<f32>,
    padding_b: f32,
}

@group(0) @binding(0) var<uniform> flare: FlareFrame;
@group(0) @binding(1) var aperture: texture_2d<f32>;
@group(0) @binding(2) var aperture_sampler: sampler;

struct GhostVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) stop: vec2<f32>,
    @location(1) barrel: vec2<f32>,
    @location(2) radiance: vec3<f32>,
    @location(3) opacity: f32,
}

@vertex
fn vs(
    @location(0) sensor_mm: vec2<f32>,
    @location(1) stop: vec2<f32>,
    @location(2) barrel: vec2<f32>,
    @location(3) radiance: vec3<f32>,
    @location(4) opacity: f32,
) -> GhostVertex {
    return GhostVertex(vec4<f32>(sensor_mm / flare.half_mm, 0.0, 1.0), stop, barrel, radiance, opacity);
}

@fragment
fn fs(in: GhostVertex) -> @location(0) vec4<f32> {
    let open = textureSample(aperture, aperture_sampler, 0.5 + 0.5 * in.stop / flare.mask_extent).x;
    // The barrel's edge, one pixel soft.
    let height = length(in.barrel);
    let soft = clamp((1.0 - height) / max(fwidth(height), 1.0e-6) + 0.5, 0.0, 1.0);
    return vec4<f32>(in.radiance * flare.irradiance * open * soft, in.opacity * open * soft);
}
