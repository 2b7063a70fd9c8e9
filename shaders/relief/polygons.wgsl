// Buildings as triangles: ground truth on the GPU and the yardstick for speed.

struct Anchor {
    // The mesh's origin, eye-relative, metres.
    at: vec4<f32>,
}

@group(1) @binding(0) var<uniform> anchor: Anchor;
@group(2) @binding(0) var ground_distance: texture_2d<f32>;

struct PolygonVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec3<f32>,
    @location(1) @interpolate(flat) normal: u32,
    @location(2) @interpolate(flat) fid: u32,
    @location(3) along: f32,
}

@vertex
fn vs(@location(0) position: vec3<f32>, @location(1) along: f32, @location(2) normal: u32, @location(3) fid: u32) -> PolygonVertex {
    let at = position + anchor.at.xyz;
    return PolygonVertex(frame.clip_from_eye_relative * vec4<f32>(at, 1.0), at, normal, fid, along);
}

@fragment
fn fs(in: PolygonVertex) -> @location(0) vec4<u32> {
    let t = length(in.at);
    if t > textureLoad(ground_distance, vec2<i32>(in.clip.xy), 0).x { discard; }
    return vec4<u32>(bitcast<u32>(t), in.fid, bitcast<u32>(in.along), in.normal);
}
