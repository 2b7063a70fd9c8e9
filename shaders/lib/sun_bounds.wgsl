// Where a ray to the sun is free for sure: what `src/relief/sun_bounds.rs` swept. Twin: `SunBounds::clear_from`.

// Elevations, metres; a layer a level.
@group(2) @binding(12) var sun_bounds: texture_2d_array<f32>;

// Metres along a ray to the sun from which it meets nothing more, FAR where that is not known.
fn clear_from(start: vec3<f32>, to_sun: vec3<f32>) -> f32 {
    // Towards the sun and across, sheared.
    let offset = start.xy - frame.sun_grid.xy;
    let along = vec2<f32>(dot(offset, frame.sun_axes.xy), dot(to_sun.xy, frame.sun_axes.xy));
    let across = vec2<f32>(dot(offset, frame.sun_axes.zw), dot(to_sun.xy, frame.sun_axes.zw)) - frame.sun_grid.z * along;
    let half = (0.5 * f32(SUN_CELLS) - SUN_BORDER) * frame.sun_grid.w;
    let level = u32(max(ceil(log2(max(abs(along.x), abs(across.x)) / half)), 0.0));
    if level >= frame.sun_levels { return FAR; }
    let cell_m = frame.sun_grid.w * f32(1u << level);
    let place = vec2<f32>(across.x, along.x) / cell_m + 0.5 * f32(SUN_CELLS);
    let step = cell_m / max(along.y, 1.0e-6);
    let advance = vec2<f32>(across.y, along.y) / cell_m;
    let height = start.z + frame.eye_elevation;
    let steps = SUN_STEPS;
    for (var k = 0u; k < 4u; k += 1u) {
        let t = steps[k] * step;
        let bound = textureLoad(sun_bounds, vec2<i32>(floor(place + t * advance)), level, 0).x;
        if height + t * to_sun.z > bound { return t; }
    }
    return FAR;
}
