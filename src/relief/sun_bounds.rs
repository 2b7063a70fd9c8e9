//! Heights above which the sun is seen for sure: most rays to the sun need not be cast, others not far.
//!
//! A grid lies round the eye, one axis towards the sun, sheared so that rays to the middle of its disc run along columns of cells. A sweep
//! from the sun's side gives every cell the height above which a ray from anywhere in it passes all roofs, and all ground that is steep
//! enough to meet a ray, on its way to any point of the disc: shadows fall by the lowest ray's slope, and are widened by a cell before
//! the disc's rays have strayed by what every block counts as larger. Levels of doubled cells reach to the city's ends.
//! The shader's part is `shaders/lib/sun_bounds.wgsl`.

use glam::{DVec2, DVec3, Vec4};
use rayon::prelude::*;

use super::sun_obstacles::SunObstacles;
use crate::buildings::Pyramid;
use crate::space::{Sun, TileGrid, TileId};
use crate::terrain::GroundBounds;

/// Cells along a level's side; shaders have it as `SUN_CELLS`.
pub const SUN_CELLS: usize = 512;
/// Levels at most: with cells of 4 m the coarsest reaches 130 km.
pub const MAX_SUN_LEVELS: usize = 8;
/// Texels of a building map along a cell of the finest level: its blocks.
const CELL_TEXELS: f64 = 4.0;
/// Cells at a level's border that belong to the next one: a ray is tested so far ahead, and strays as little; shaders have it as `SUN_BORDER`.
pub const SUN_BORDER: f64 = 10.0;
/// What stands in a cell counts as larger by this part of the cell: as far as the disc's rays stray from its middle's in the rows until
/// shadows are widened. Bounds count as higher, metres: rounding.
const GROWN: f64 = 0.1;
const MARGIN_M: f32 = 0.003;
/// The disc counts as larger by this factor, and slopes of the ground as steeper: rounding of directions.
const DISC: f64 = 1.02;
const STEEPER: f32 = 1.02;
/// Cells ahead, one after another, at which a ray is tested; shaders have them as `SUN_STEPS`.
pub const SUN_STEPS: [f32; 4] = [0.0, 1.0, 2.5, 7.0];

/// Bounds round a point.
#[derive(Clone, Debug)]
pub struct SunBounds {
    centre: DVec2,
    /// Towards the sun and across, along the axes of the city's CRS.
    axes: [DVec2; 2],
    /// Shear: metres across for a metre towards the sun.
    shear: f64,
    /// Side of a cell of the finest level, metres.
    cell_m: f64,
    /// Elevations, metres, level by level: rows towards the sun, in a row the cells across.
    levels: Vec<Vec<f32>>,
}

/// The sweep's parameters: how a level's shadows fall and spread.
struct Fall {
    /// Tangent of the lowest ray's altitude.
    tan_low: f64,
    /// Metres of path in plan for a metre along the axis.
    path: f64,
    /// Metres across for a metre along the axis, at most.
    spread: f64,
}

impl SunBounds {
    /// Round a point of the city; none where the sun is so low or so high that they would say nothing.
    pub fn new(obstacles: &SunObstacles, sun: &Sun, centre: DVec2, texel_m: f64) -> Option<Self> {
        let plan = sun.to_sun.truncate();
        let radius = DISC * sun.angular_radius;
        let altitude = sun.to_sun.z.clamp(-1.0, 1.0).asin();
        let lowest = altitude - radius;
        let azimuth_spread = (radius.sin() / plan.length()).clamp(-1.0, 1.0).asin();
        if lowest <= 0.0 || !azimuth_spread.is_finite() {
            return None;
        }
        let is_along_x = plan.x.abs() >= plan.y.abs();
        let axes = match is_along_x {
            true => [DVec2::X * plan.x.signum(), DVec2::Y],
            false => [DVec2::Y * plan.y.signum(), DVec2::X],
        };
        let shear = plan.dot(axes[1]) / plan.dot(axes[0]);
        let fall = Fall {
            tan_low: lowest.tan(),
            path: (1.0 + shear * shear).sqrt(),
            // Both ways from the middle of the disc, to second order.
            spread: azimuth_spread
                * (1.0 + shear * shear)
                * (1.0 + 2.0 * azimuth_spread * (1.0 + shear.abs())),
        };
        if fall.spread > GROWN {
            return None;
        }
        let cell_m = CELL_TEXELS * texel_m;
        let bounds = obstacles.grid.bounds();
        let corners = [
            [bounds.west, bounds.south],
            [bounds.east, bounds.south],
            [bounds.west, bounds.north],
            [bounds.east, bounds.north],
        ];
        let farthest = corners
            .iter()
            .map(|corner| {
                let from = DVec2::from_array(*corner) - centre;
                let u = from.dot(axes[0]);
                u.abs().max((from.dot(axes[1]) - shear * u).abs())
            })
            .fold(0.0, f64::max);
        let half = 0.5 * SUN_CELLS as f64 - SUN_BORDER - 1.0;
        let count = ((farthest / (half * cell_m)).log2().ceil().max(0.0) as usize + 1).min(MAX_SUN_LEVELS);
        let mut grid = Self {
            centre,
            axes,
            shear,
            cell_m,
            levels: Vec::new(),
        };
        let heights: Vec<Vec<f32>> = (0..count)
            .into_par_iter()
            .map(|level| grid.gather(obstacles, level, fall.tan_low as f32))
            .collect();
        let reaches_all = half * cell_m * f64::from(1_u32 << (count - 1)) >= farthest;
        for (level, heights) in heights.into_iter().enumerate().rev() {
            // What comes from beyond: of the coarser level already swept, or nothing where the city ends.
            let beyond = match grid.levels.last() {
                Some(coarser) => Beyond::Level(coarser),
                None if reaches_all => Beyond::Nothing,
                None => Beyond::Unknown,
            };
            let swept = sweep(heights, &beyond, &fall, grid.level_cell_m(level));
            grid.levels.push(swept);
        }
        grid.levels.reverse();
        Some(grid)
    }

    fn level_cell_m(&self, level: usize) -> f64 {
        self.cell_m * f64::from(1_u32 << level)
    }

    /// The highest that stands in each cell of a level: roofs, and ground that is as steep as the lowest ray.
    fn gather(&self, obstacles: &SunObstacles, level: usize, tan_low: f32) -> Vec<f32> {
        let mut heights = vec![f32::NEG_INFINITY; SUN_CELLS * SUN_CELLS];
        let cell_m = self.level_cell_m(level);
        let grid = &obstacles.grid;
        for (id, roofs) in &obstacles.roofs {
            if self.meets(grid, *id, level) {
                let (corner, tile_m) = (grid.origin(*id), grid.level_tile_m(id.level));
                let node_level = roof_level(roofs, tile_m, cell_m);
                let side = tile_m / roofs.children(node_level) as f64;
                for ([column, row], roof) in roofs.standing(node_level) {
                    let at = corner + side * DVec2::new(column as f64, row as f64);
                    self.raise(&mut heights, cell_m, (at, side), roof);
                }
            }
        }
        for (id, ground, steps) in &obstacles.ground {
            if self.meets(grid, *id, level) {
                let (corner, tile_m) = (grid.origin(*id), grid.level_tile_m(id.level));
                let side = tile_m / GroundBounds::BLOCKS as f64;
                let is_gentle = ground.max_slope() * STEEPER < tan_low;
                if is_gentle && !steps.contains(&true) {
                    continue;
                }
                for row in 0..GroundBounds::BLOCKS {
                    for column in 0..GroundBounds::BLOCKS {
                        let last = GroundBounds::BLOCKS - 1;
                        let on_side = [row == 0, column == last, row == last, column == 0];
                        let is_step = on_side.iter().zip(steps).any(|(on, step)| *on && *step);
                        if is_step || ground.slope(column, row) * STEEPER >= tan_low {
                            let at = corner + side * DVec2::new(column as f64, row as f64);
                            self.raise(&mut heights, cell_m, (at, side), ground.max(0, column, row));
                        }
                    }
                }
            }
        }
        heights
    }

    /// Whether a tile may have a part in a level.
    fn meets(&self, grid: &TileGrid, id: TileId, level: usize) -> bool {
        let half = 0.5 * SUN_CELLS as f64 * self.level_cell_m(level);
        let side = grid.level_tile_m(id.level);
        let centre = grid.origin(id) + 0.5 * side;
        let [u, v] = self.sheared(centre);
        // The tile is a parallelogram there, up to twice as wide.
        u.abs() <= half + 0.5 * side && v.abs() <= half + side
    }

    /// A point along the grid's axes, metres from its centre.
    fn sheared(&self, point: DVec2) -> [f64; 2] {
        let from = point - self.centre;
        let u = from.dot(self.axes[0]);
        [u, from.dot(self.axes[1]) - self.shear * u]
    }

    /// Raises all cells that a square may meet to a height. `square`: its south-west corner and its side.
    fn raise(&self, heights: &mut [f32], cell_m: f64, (corner, side): (DVec2, f64), height: f32) {
        let grown = GROWN * cell_m;
        let low = corner - grown;
        let high = corner + side + grown;
        let along = [low, high].map(|at| (at - self.centre).dot(self.axes[0]));
        let across = [low, high].map(|at| (at - self.centre).dot(self.axes[1]));
        let (u0, u1) = (along[0].min(along[1]), along[0].max(along[1]));
        let last = SUN_CELLS as i64 - 1;
        // Rounded down: counted from below all cells, where a cast does.
        let per_m = 1.0 / cell_m;
        let cell = |metres: f64| (metres * per_m + (SUN_CELLS / 2 + 1) as f64) as i64 - 1;
        for i in cell(u0).max(0)..=cell(u1).min(last) {
            let edge = (i - SUN_CELLS as i64 / 2) as f64 * cell_m;
            let shift = [u0.max(edge), u1.min(edge + cell_m)].map(|u| self.shear * u);
            let v0 = across[0].min(across[1]) - shift[0].max(shift[1]);
            let v1 = across[0].max(across[1]) - shift[0].min(shift[1]);
            let row = i as usize * SUN_CELLS;
            for j in cell(v0).max(0)..=cell(v1).min(last) {
                let known = &mut heights[row + j as usize];
                *known = known.max(height);
            }
        }
    }

    /// Metres along a ray to the sun from which it meets nothing more; infinite where that is not known.
    pub fn clear_from(&self, start: DVec3, to_sun: DVec3) -> f64 {
        let [u, v] = self.sheared(start.truncate());
        let half = (0.5 * SUN_CELLS as f64 - SUN_BORDER) * self.cell_m;
        let level = (u.abs().max(v.abs()) / half).log2().ceil().max(0.0) as usize;
        let Some(bounds) = self.levels.get(level) else {
            return f64::INFINITY;
        };
        let cell_m = self.level_cell_m(level);
        let ahead = to_sun.truncate().dot(self.axes[0]);
        let aside = to_sun.truncate().dot(self.axes[1]) - self.shear * ahead;
        let cell = |metres: f64| (metres / cell_m + 0.5 * SUN_CELLS as f64).floor() as usize;
        let clear = |cells: &f32| {
            let t = f64::from(*cells) * cell_m / ahead.max(1e-6);
            let bound = bounds.get(cell(u + t * ahead) * SUN_CELLS + cell(v + t * aside))?;
            (start.z + t * to_sun.z > f64::from(*bound)).then_some(t)
        };
        SUN_STEPS.iter().find_map(clear).unwrap_or(f64::INFINITY)
    }

    /// What shaders take, for an eye in plan: the centre from the eye, shear, side of a cell; the axes; and the number of levels.
    pub fn uniforms(&self, eye: DVec2) -> ([Vec4; 2], u32) {
        let from_eye = (self.centre - eye).as_vec2();
        let grid = from_eye.extend(self.shear as f32).extend(self.cell_m as f32);
        let [along, across] = self.axes.map(DVec2::as_vec2);
        let axes = Vec4::new(along.x, along.y, across.x, across.y);
        ([grid, axes], self.levels.len() as u32)
    }

    /// The elevations of the levels, the finest first.
    pub fn levels(&self) -> &[Vec<f32>] {
        &self.levels
    }
}

/// The coarsest children of a tile's pyramid that are no larger than a cell, or its finest.
fn roof_level(roofs: &Pyramid, tile_m: f64, cell_m: f64) -> u32 {
    let fits = |level: &u32| tile_m / roofs.children(*level) as f64 <= 1.01 * cell_m;
    (1..=roofs.top()).rev().find(fits).unwrap_or(1)
}

/// What shadows come in from beyond a level's end.
enum Beyond<'a> {
    Nothing,
    Unknown,
    /// The next level's bounds.
    Level(&'a [f32]),
}

/// The highest of a cell and its two neighbours across; `edge` beyond the row.
fn widened(row: &[f32], edge: f32) -> Vec<f32> {
    (0..row.len())
        .map(|j| {
            let before = if j == 0 { edge } else { row[j - 1] };
            row[j].max(before).max(row.get(j + 1).copied().unwrap_or(edge))
        })
        .collect()
}

/// From the highest in each cell to the height above which a ray from it is free.
fn sweep(heights: Vec<f32>, beyond: &Beyond<'_>, fall: &Fall, cell_m: f64) -> Vec<f32> {
    let edge = match beyond {
        Beyond::Nothing => f32::NEG_INFINITY,
        Beyond::Unknown | Beyond::Level(_) => f32::INFINITY,
    };
    let mut shadow: Vec<f32> = match beyond {
        Beyond::Nothing => vec![f32::NEG_INFINITY; SUN_CELLS],
        Beyond::Unknown => vec![f32::INFINITY; SUN_CELLS],
        Beyond::Level(coarser) => {
            // The next level's row that begins where this one ends, and the cells over each of its cells.
            let row = &coarser[3 * SUN_CELLS / 4 * SUN_CELLS..][..SUN_CELLS];
            let row = widened(row, f32::INFINITY);
            (0..SUN_CELLS).map(|j| row[SUN_CELLS / 4 + j / 2]).collect()
        }
    };
    let drop = (cell_m * fall.path * fall.tan_low) as f32;
    // Before so many rows no ray has strayed farther than blocks are grown.
    let widening = (GROWN / fall.spread).floor().max(1.0) as usize;
    let mut bounds = heights;
    for i in (0..SUN_CELLS).rev() {
        let row = &mut bounds[i * SUN_CELLS..][..SUN_CELLS];
        for (bound, shadow) in row.iter_mut().zip(&mut shadow) {
            let standing = *bound;
            *bound = standing.max(*shadow) + MARGIN_M;
            *shadow = standing.max(*shadow - drop);
        }
        if i % widening == 0 {
            shadow = widened(&shadow, edge);
        }
    }
    bounds
}
