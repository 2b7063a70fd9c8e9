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
    @location(3) bays: f32,
    @location(4) @interpolate(flat) material: u32,
    // Bays a metre; the base, eye-relative; height of the roof above it.
    @location(5) @interpolate(flat) facade: vec3<f32>,
}

@vertex
fn vs(
    @location(0) position: vec3<f32>,
    @location(1) bays: f32,
    @location(2) normal: u32,
    @location(3) fid: u32,
    @location(4) material: u32,
    @location(5) facade: vec3<f32>,
) -> PolygonVertex {
    let at = position + anchor.at.xyz;
    let clip = frame.clip_from_eye_relative * vec4<f32>(at, 1.0);
    return PolygonVertex(clip, at, normal, fid, bays, material, facade + vec3<f32>(0.0, anchor.at.z, 0.0));
}

@fragment
fn fs(in: PolygonVertex) -> BuildingTexels {
    let t = length(in.at);
    if t > textureLoad(ground_distance, vec2<i32>(in.clip.xy), 0).x { discard; }
    let surface = vec4<u32>(bitcast<u32>(t), in.fid, bitcast<u32>(in.bays), in.normal);
    return BuildingTexels(surface, vec4<u32>(bitcast<vec3<u32>>(in.facade), in.material));
}
