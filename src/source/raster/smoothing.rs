//! Smooths heights stored in whole steps: the tautest surface that stays within half a step of every stored height.
//!
//! Relaxation of Laplace's equation between an upper and a lower obstacle (projected Jacobi iteration, Cryer 1971), from
//! coarse spacings to fine ones so that wide plateaus slope too. Every value depends on the pixels within `halo` alone and
//! on their numbers in the raster, so whatever window is read, the same pixel gets the same height.

use super::height_steps::is_multiple;
use super::smoothing_grid::Grid;
use super::window::Window;

/// Half the width of the plateaus that become slopes, metres.
const RADIUS_M: f64 = 32.0;

/// Sweeps at each spacing.
const SWEEPS: usize = 4;

/// Steps between neighbours above which the ground is no plateau at that spacing, and stays: a taut surface would flatten
/// its hills and hollows, and finer spacings do what is left to do.
const STEEP_STEPS: f32 = 1.5;

/// Side of the blocks by which water is told from slopes, metres.
const BLOCK_M: f64 = 8.0;

/// Water is level this many blocks around, and meets nothing lower so many blocks around.
const LEVEL_BLOCKS: usize = 3;
const SHORE_BLOCKS: usize = 12;

/// How heights of one raster are smoothed.
#[derive(Clone, Copy, Debug)]
pub struct Smoothing {
    /// The step of the stored heights, metres.
    pub step_m: f64,
    /// Coarsest spacing, 2^levels pixels.
    levels: usize,
    /// Pixels along a side of a block.
    block: usize,
}

impl Smoothing {
    /// For a raster of `pixel_m` metres whose heights are multiples of `step_m`.
    pub fn new(step_m: f64, pixel_m: f64) -> Self {
        let power = |metres: f64| (metres / pixel_m).max(1.0).log2().floor().min(6.0) as usize;
        Self {
            step_m,
            levels: power(RADIUS_M),
            block: 1 << power(BLOCK_M),
        }
    }

    /// Pixels around a block that its heights depend on.
    pub fn halo(&self) -> usize {
        reach(self.levels) + (LEVEL_BLOCKS + SHORE_BLOCKS + 1) * self.block
    }

    /// Smooths the block from `low` to `high`, pixels of the raster, of a window that holds `halo` pixels around it or ends
    /// where the raster does.
    pub fn smooth(&self, window: &Window, low: [usize; 2], high: [usize; 2]) -> Window {
        let fixed = self.fixed(window);
        let half = 0.5 * self.step_m as f32;
        let mut coarser: Option<Grid> = None;
        for level in (0..=self.levels).rev() {
            let low = low.map(|pixel| pixel.saturating_sub(reach(level)));
            let mut grid = Grid::new(window, [low, high.map(|pixel| pixel + reach(level))], level);
            let bounds: Vec<[f32; 2]> = grid
                .pixels()
                .map(|pixel| {
                    let half = if fixed[pixel] { 0.0 } else { half };
                    [window.heights[pixel] - half, window.heights[pixel] + half]
                })
                .collect();
            if let Some(coarser) = &coarser {
                grid.take(coarser);
            }
            grid.hold(&bounds);
            let steep = grid.steep(window, STEEP_STEPS * self.step_m as f32);
            for _ in 0..SWEEPS {
                grid.sweep(&steep);
                grid.hold(&bounds);
            }
            coarser = Some(grid);
        }
        let size = [high[0] - low[0], high[1] - low[1]];
        let heights = coarser.map_or_else(Vec::new, |grid| {
            let start = |row: usize| (low[1] + row - grid.first[1]) * grid.size[0] + low[0] - grid.first[0];
            let rows = (0..size[1]).map(|row| &grid.heights[start(row)..start(row) + size[0]]);
            rows.flatten().copied().collect()
        });
        Window {
            first: low,
            size,
            heights,
        }
    }

    /// Pixels that stay: finer heights than the step, and level water (level all around, and nothing lower near).
    fn fixed(&self, window: &Window) -> Vec<bool> {
        let [width, height] = window.size;
        let mut fixed: Vec<bool> = window
            .heights
            .iter()
            .map(|&h| !is_multiple(h, self.step_m))
            .collect();
        let first = window.first.map(|pixel| pixel / self.block);
        let block = [0, 1].map(|axis| {
            let numbers = 0..window.size[axis];
            let block = numbers.map(|k| (window.first[axis] + k) / self.block - first[axis]);
            block.collect::<Vec<usize>>()
        });
        let blocks = [0, 1].map(|axis| block[axis].last().map_or(0, |last| last + 1));
        let mut ranges = vec![[f32::INFINITY, f32::NEG_INFINITY]; blocks[0] * blocks[1]];
        for row in 0..height {
            for column in 0..width {
                let at = window.heights[row * width + column];
                if at.is_finite() {
                    let [min, max] = &mut ranges[block[1][row] * blocks[0] + block[0][column]];
                    (*min, *max) = (min.min(at), max.max(at));
                }
            }
        }
        let near = |column: usize, row: usize, around: usize| {
            let columns = column.saturating_sub(around)..(column + around + 1).min(blocks[0]);
            let rows = row.saturating_sub(around)..(row + around + 1).min(blocks[1]);
            rows.flat_map(move |row| columns.clone().map(move |column| row * blocks[0] + column))
        };
        let mut water = vec![false; ranges.len()];
        for row in 0..blocks[1] {
            for column in 0..blocks[0] {
                let [min, max] = ranges[row * blocks[0] + column];
                let level = min == max
                    && near(column, row, LEVEL_BLOCKS).all(|k| ranges[k] == [min, max])
                    && near(column, row, SHORE_BLOCKS).all(|k| ranges[k][0] >= min);
                if level {
                    near(column, row, LEVEL_BLOCKS).for_each(|k| water[k] = true);
                }
            }
        }
        for row in 0..height {
            for column in 0..width {
                fixed[row * width + column] |= water[block[1][row] * blocks[0] + block[0][column]];
            }
        }
        fixed
    }
}

/// Pixels of a spacing that a block's heights depend on, through it and all finer ones.
fn reach(level: usize) -> usize {
    (SWEEPS + 1) * ((2 << level) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(first: [usize; 2], size: [usize; 2], height: impl Fn(f64, f64) -> f64) -> Window {
        let at = |k: usize| height((first[0] + k % size[0]) as f64, (first[1] + k / size[0]) as f64);
        Window {
            first,
            size,
            heights: (0..size[0] * size[1]).map(|k| at(k) as f32).collect(),
        }
    }

    #[test]
    fn a_plane_in_whole_metres_becomes_the_plane_again() {
        let plane = |x: f64, y: f64| 100.0 + 0.03 * x + 0.011 * y;
        let stored = window([3, 5], [1400, 1300], |x, y| plane(x, y).round());
        let smoothed = Smoothing::new(1.0, 1.0).smooth(&stored, [3, 5], [1403, 1305]);
        let (mut sum, mut count) = (0.0, 0.0);
        for (k, &height) in smoothed.heights.iter().enumerate() {
            assert!((height - stored.heights[k]).abs() <= 0.5001);
            let (x, y) = (k % 1400, k / 1400);
            if (450..950).contains(&x) && (450..850).contains(&y) {
                sum += (f64::from(height) - plane((x + 3) as f64, (y + 5) as f64)).powi(2);
                count += 1.0;
            }
        }
        // A rounded plane is off by 1 / sqrt(12) = 0.29 m.
        let rms = f64::sqrt(sum / count);
        assert!(rms < 0.05, "{rms}");
    }

    #[test]
    fn any_window_gives_the_same_heights() {
        let ground = |x: f64, y: f64| (80.0 + 9.0 * (x / 60.0).sin() + 7.0 * (y / 41.0).cos()).round();
        let smoothing = Smoothing::new(1.0, 2.0);
        let halo = smoothing.halo();
        let part = |first: [usize; 2]| {
            let stored = window(first, [2 * halo + 40; 2], ground);
            smoothing.smooth(&stored, first.map(|k| k + halo), first.map(|k| k + halo + 40))
        };
        let (a, b) = (part([100, 200]), part([113, 207]));
        for y in 0..30 {
            for x in 0..20 {
                let at = |part: &Window| {
                    let [column, row] = [113 + halo + x - part.first[0], 207 + halo + y - part.first[1]];
                    part.heights[row * part.size[0] + column].to_bits()
                };
                assert_eq!(at(&a), at(&b));
            }
        }
    }

    #[test]
    fn a_lake_and_finer_heights_stay() {
        let ground =
            |x: f64, y: f64| (50.0 + (0.1 * ((x - 700.0).hypot(y - 700.0) - 150.0)).max(0.0)).round();
        let mut stored = window([0, 0], [1400; 2], ground);
        let fine = stored.heights[700 * 1400 + 300] + 0.3;
        stored.heights[700 * 1400 + 300] = fine;
        let smoothed = Smoothing::new(1.0, 1.0).smooth(&stored, [0, 0], [1400; 2]);
        assert_eq!(smoothed.heights[700 * 1400 + 300], fine);
        for (k, &height) in smoothed.heights.iter().enumerate() {
            let (x, y) = ((k % 1400) as f64, (k / 1400) as f64);
            if (x - 700.0).hypot(y - 700.0) < 120.0 {
                assert_eq!(height, 50.0, "{x} {y}");
            }
        }
    }
}
