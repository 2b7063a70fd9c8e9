//! Rays against the ground on the CPU, function for function `shaders/lib/ground_march.wgsl`, f32 like the shader. Cells with
//! missing samples are open.

use glam::{IVec2, Vec2, Vec3Swizzles};

use super::GridPosition;
use super::constants::MAX_STEPS;
use super::march::{LocalRay, Ray, across_grid, lead, slack, tile_over, tile_past};
use crate::scene::{GroundTile, TileSet};
use crate::terrain::GroundBounds;

/// Where a ray leaves a square, metres along it. `border`: the two sides ahead, in the coordinates of `start`.
fn leaves(border: Vec2, start: Vec2, ray: &Ray) -> f32 {
    ((border - start) * ray.inverse).min_element()
}

/// A lattice cell.
struct Cell {
    /// South-west, south-east, north-west, north-east, metres.
    heights: [f32; 4],
    /// Side, metres.
    size_m: f32,
    /// The ray's start, cells from the cell's corner.
    start: Vec2,
}

/// First meeting with the bilinear surface of a cell between `t0` and `t1`: a quadratic in t (Ramsey, Potter & Hansen 2004,
/// "Ray Bilinear Patch Intersections", for a patch over a square).
fn meet_cell(cell: &Cell, local: &LocalRay<'_>, [t0, t1]: [f32; 2]) -> Option<f32> {
    let h = cell.heights;
    let d = local.ray.direction.xy() / cell.size_m;
    // Counted from t0, for the sake of its digits.
    let p = cell.start + t0 * d;
    let slope = Vec2::new(h[1] - h[0], h[2] - h[0]);
    let twist = h[0] - h[1] - h[2] + h[3];
    // Height of the ray above the surface: c + b s + a s², s = t - t0.
    let z = local.ray.start.z + t0 * local.ray.direction.z + local.eye_elevation;
    let c = z - (h[0] + slope.dot(p) + twist * p.x * p.y);
    if c <= 0.0 {
        return Some(t0);
    }
    let b = local.ray.direction.z - slope.dot(d) - twist * (p.x * d.y + p.y * d.x);
    let a = -twist * d.x * d.y;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    // The root at which the ray goes down through the surface, without cancellation.
    let s = 2.0 * c / (-b + discriminant.sqrt());
    (s >= 0.0 && t0 + s <= t1).then_some(t0 + s)
}

/// First meeting with the ground of one tile between `t0` and `t1`, cell by cell.
fn walk_cells(ground: &GroundTile, local: &LocalRay<'_>, [t0, t1]: [f32; 2]) -> Option<f32> {
    let LocalRay { ray, start, .. } = *local;
    let lead = lead([ray.direction.x >= 0.0, ray.direction.y >= 0.0]);
    let (side, size_m) = (ground.heights.side, ground.heights.step_m as f32);
    let max_cell = IVec2::splat(side as i32 - 2);
    let mut t = t0;
    for _ in 0..MAX_STEPS {
        let position = (start + (t + slack(t)) * ray.direction.xy()) / size_m;
        let corner = position.floor().as_ivec2().clamp(IVec2::ZERO, max_cell);
        let t_past = t1.min(leaves((corner.as_vec2() + lead) * size_m, start, ray).max(t));
        let first = corner.y as usize * side + corner.x as usize;
        let cell = Cell {
            heights: [first, first + 1, first + side, first + side + 1]
                .map(|sample| ground.heights.heights[sample]),
            size_m,
            start: start / size_m - corner.as_vec2(),
        };
        let met = meet_cell(&cell, local, [t, t_past]);
        if met.is_some() {
            return met;
        }
        t = t_past.max(t + slack(t));
        if t >= t1 {
            break;
        }
    }
    None
}

/// Where a rising ray has passed what is no higher than `bound` metres, at most `t1`.
fn clears(bound: f32, local: &LocalRay<'_>, t1: f32) -> f32 {
    let LocalRay {
        ray, eye_elevation, ..
    } = *local;
    if ray.direction.z <= 0.0 {
        return t1;
    }
    let t = (bound - eye_elevation - ray.start.z) / ray.direction.z;
    t1.min(t + slack(t.abs()))
}

/// First meeting with the ground of one tile between `t0` and `t1`.
fn walk_ground_tile(ground: &GroundTile, local: &LocalRay<'_>, [t0, t1]: [f32; 2]) -> Option<f32> {
    let LocalRay {
        ray,
        start,
        eye_elevation,
    } = *local;
    let lead = lead([ray.direction.x >= 0.0, ray.direction.y >= 0.0]);
    let tile_m = (ground.heights.step_m * (ground.heights.side - 1) as f64) as f32;
    // Only below the tile's highest ground.
    let end = clears(ground.bounds.max(GroundBounds::LEVELS - 1, 0, 0), local, t1);
    let (mut t, mut level) = (t0, 0_u32);
    if t >= end {
        return None;
    }
    for _ in 0..MAX_STEPS {
        let blocks = (GroundBounds::BLOCKS >> level) as i32;
        let size = tile_m / blocks as f32;
        let position = (start + (t + slack(t)) * ray.direction.xy()) / size;
        let block = position
            .floor()
            .as_ivec2()
            .clamp(IVec2::ZERO, IVec2::splat(blocks - 1));
        let t_past = end.min(leaves((block.as_vec2() + lead) * size, start, ray).max(t));
        let lowest = ray.start.z + (t * ray.direction.z).min(t_past * ray.direction.z) + eye_elevation;
        let bound = ground.bounds.max(level, block.x as usize, block.y as usize);
        if lowest <= bound {
            if level > 0 {
                level -= 1;
                continue;
            }
            let met = walk_cells(ground, local, [t, clears(bound, local, t_past)]);
            if met.is_some() {
                return met;
            }
        } else {
            level = (level + 1).min(GroundBounds::LEVELS - 1);
        }
        t = t_past.max(t + slack(t));
        if t >= end {
            break;
        }
    }
    None
}

/// First meeting with the ground of any tile between `t0` and `t1`, metres along a ray whose start counts from `eye`.
pub fn walk_ground(tiles: &TileSet, eye: &GridPosition, ray: &Ray, [t0, t1]: [f32; 2]) -> Option<f32> {
    let grid = &tiles.grid;
    let lead = lead([ray.direction.x >= 0.0, ray.direction.y >= 0.0]);
    let [t_in, t_out] = across_grid(tiles, eye, ray);
    let (mut t, mut end) = (t0.max(t_in), t1.min(t_out));
    // A rising ray has passed all ground at the height of the highest.
    let t_top = (tiles.bounds.max_ground - eye.elevation - ray.start.z) / ray.direction.z;
    if ray.direction.z > 0.0 {
        end = end.min(t_top);
    } else {
        t = t.max(t_top);
    }
    let mut tile = eye.tile_at(grid, ray.start.xy() + t * ray.direction.xy());
    for _ in 0..MAX_STEPS {
        if t >= end {
            break;
        }
        let (level, ground) = tiles.ground_over(tile);
        let first = tile_over(tile, level);
        let corner = eye.tile_corner(grid, first);
        let tile_m = grid.tile_m as f32 * (1_u32 << level) as f32;
        let t_border = (corner + lead * tile_m - ray.start.xy()) * ray.inverse;
        let t_past = t_border.min_element().min(end);
        if t_past > t
            && let Some(ground) = ground
        {
            let local = LocalRay {
                ray,
                start: ray.start.xy() - corner,
                eye_elevation: eye.elevation,
            };
            let met = walk_ground_tile(ground, &local, [t, t_past]);
            if met.is_some() {
                return met;
            }
        }
        t = t.max(t_past);
        let position = eye.tile_at(grid, ray.start.xy() + t * ray.direction.xy());
        tile = tile_past(first, level, position, ray, t_border);
    }
    None
}
