//! A viewport larger than its target: triangles that cross the target's edges are not cut by them, which software devices pay dearly for.

use crate::gpu::Target;

/// Sides of the viewport by the target's, at most.
const MAX_SIDES: f32 = 8.0;
/// Longest side of a viewport that every device has, pixels (WebGPU's default limit).
const LONGEST_PX: f32 = 8192.0;

/// Sides of the viewport for a target of at most `size` pixels, by its own.
pub fn guard_sides(size: [u32; 2]) -> f32 {
    (LONGEST_PX / size[0].max(size[1]).max(1) as f32).clamp(1.0, MAX_SIDES)
}

/// Sets the viewport so many times as large as the pass's target, round its centre.
pub fn set_guard_band(pass: &mut wgpu::RenderPass<'_>, target: &Target, sides: f32) {
    let [width, height] = target.size().map(|side| side as f32);
    let start = 0.5 * (1.0 - sides);
    let (x, y) = (start * width, start * height);
    pass.set_viewport(x, y, sides * width, sides * height, 0.0, 1.0);
}
