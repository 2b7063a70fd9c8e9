// How far the iris is open at a point of the stop, softened by discs, slice by slice larger (src/camera/flare/draw/soft_masks.rs).

@group(0) @binding(3) var soft_apertures: texture_3d<f32>;

fn iris_open(stop: vec2<f32>, slice: f32) -> f32 {
    let at = vec3<f32>(0.5 + 0.5 * stop / SOFT_EXTENT, slice);
    return textureSampleLevel(soft_apertures, aperture_sampler, at, 0.0).x;
}
