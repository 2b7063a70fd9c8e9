//! How many patches a nonlinear ghost is drawn with: as many as its curvature asks for, seen against its softness.

use glam::DVec2;

use super::grid::RayGrid;
use super::softness::Softness;
use crate::camera::trace::TracedRay;

/// Distance on the sensor that is not seen, as a fraction of the sensor's half diagonal; more where the ghost's edge is soft.
const UNSEEN: f64 = 0.0006;
/// The same as a fraction of the softness.
const UNSEEN_SOFT: f64 = 0.12;
/// Distance in the stop, in radii of the iris.
const UNSEEN_STOP: f64 = 0.008;
/// Height by the barrel's.
const UNSEEN_HEIGHT: f64 = 0.01;
/// Largest of either, of a ghost however small.
const MAX_UNSEEN: f64 = 0.1;
/// Least patches along an edge.
const MIN_PATCHES: f64 = 3.0;

/// Rays along an edge of the grid over a window of the entrance that draws a ghost as near as can be seen; `known` is a coarser or
/// other grid of the same ghost.
pub fn rays_needed(
    known: &RayGrid,
    [min, max]: [DVec2; 2],
    softness: &Softness,
    (stop_mm, half_diagonal_mm): (f64, f64),
    most: usize,
) -> usize {
    let size = known.size;
    let spacing = (known.max - known.min) / (size - 1) as f64;
    let seen = |ray: &TracedRay| {
        ray.relative_height <= 1.0 + softness.front.min(0.2)
            && ray.stop_mm.length() <= (1.1 + softness.stop.min(0.5)) * stop_mm
    };
    let unseen_mm = (UNSEEN * half_diagonal_mm).max(UNSEEN_SOFT * softness.edge_mm);
    // A radius of the iris, and of the front, is half of the ghost at least: what is not seen of a small one.
    let lands = known
        .rays
        .iter()
        .flatten()
        .filter(|ray| seen(ray))
        .map(|ray| ray.sensor_mm);
    let [low, high] = lands.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], at| {
        [low.min(at), high.max(at)]
    });
    let unseen_radii = (2.0 * unseen_mm / (high - low).max_element().max(1e-9)).min(MAX_UNSEEN);
    // Between two rays a distance h apart, a straight line is off by an eighth of the second difference at h.
    let unseen = 8.0
        * DVec2::new(
            unseen_mm,
            UNSEEN_STOP.max(UNSEEN_SOFT * softness.stop).max(unseen_radii) * stop_mm,
        );
    let unseen_height = 8.0 * UNSEEN_HEIGHT.max(UNSEEN_SOFT * softness.front).max(unseen_radii);
    let mut patches = MIN_PATCHES;
    let mut has_seen = false;
    for k in 0..size * size {
        let (column, row) = (k % size, k / size);
        for (axis, step, index) in [(0, 1, column), (1, size, row)] {
            if index == 0 || index + 1 >= size {
                continue;
            }
            let [a, b, c] = [known.rays[k - step], known.rays[k], known.rays[k + step]];
            let (Some(a), Some(b), Some(c)) = (a, b, c) else {
                continue;
            };
            if !seen(&b) {
                continue;
            }
            has_seen = true;
            let bend = |of: fn(&TracedRay) -> DVec2| (of(&a) - 2.0 * of(&b) + of(&c)).length();
            let height = (a.relative_height - 2.0 * b.relative_height + c.relative_height).abs();
            let off = (bend(|ray| ray.sensor_mm) / unseen.x)
                .max(bend(|ray| ray.stop_mm) / unseen.y)
                .max(height / unseen_height);
            patches = patches.max((max - min)[axis] / spacing[axis] * off.sqrt());
        }
    }
    if !has_seen {
        return most;
    }
    (patches.ceil() as usize + 1).clamp(2, most.max(2))
}
