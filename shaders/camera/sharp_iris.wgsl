// How far the iris is open at a point of the stop, for ghosts that are not softened there.

@group(0) @binding(1) var aperture: texture_2d<f32>;

fn iris_open(stop: vec2<f32>, slice: f32) -> f32 {
    return textureSampleLevel(aperture, aperture_sampler, 0.5 + 0.5 * stop / MASK_EXTENT, 0.0).x;
}
