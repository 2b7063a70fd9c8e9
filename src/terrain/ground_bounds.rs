//! The pyramid of maxima over a tile's ground: rays to the sun pass what they stay above of in one read, as they pass roofs
//! (maximum mipmaps: Tevs, Ihrke & Seidel 2008).

use std::ops::Range;

use super::HeightTile;

/// Highest ground of square blocks of a tile, level by level.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundBounds {
    /// Metres, row by row from the south; level l has `BLOCKS >> l` blocks along a side, down to one. Negative infinity where there
    /// is no ground.
    levels: Vec<Vec<f32>>,
    /// Steepest slope of each block of level 0, metres a metre; 0 where there is no ground.
    slopes: Vec<f32>,
}

impl GroundBounds {
    /// Blocks along a tile's side on level 0, a power of two.
    pub const BLOCKS: usize = 64;
    /// Levels, the last of one block.
    pub const LEVELS: u32 = Self::BLOCKS.ilog2() + 1;

    /// Of a tile's bilinear surface, which is highest at samples: a block counts every sample of the cells that it touches.
    pub fn from_heights(tile: &HeightTile) -> Self {
        let cells = tile.side - 1;
        let samples = |block: usize| {
            let first = block * cells / Self::BLOCKS;
            let last = ((block + 1) * cells).div_ceil(Self::BLOCKS);
            first..last.min(cells) + 1
        };
        let mut levels = vec![block_maxima(&tile.heights, tile.side, Self::BLOCKS, samples)];
        for level in 1..Self::LEVELS {
            let blocks = Self::BLOCKS >> level;
            let below = &levels[level as usize - 1];
            levels.push(block_maxima(below, 2 * blocks, blocks, |block| {
                2 * block..2 * block + 2
            }));
        }
        // The gradient of a bilinear cell is no steeper than its steepest edges together.
        let mut squares = Vec::with_capacity(cells * cells);
        for pair in tile.heights.windows(2 * tile.side).step_by(tile.side) {
            let (south, north) = pair.split_at(tile.side);
            let edges = south.windows(2).zip(north.windows(2));
            squares.extend(edges.map(|(a, b)| {
                let east = (a[1] - a[0]).abs().max((b[1] - b[0]).abs());
                let north = (b[0] - a[0]).abs().max((b[1] - a[1]).abs());
                east * east + north * north
            }));
        }
        let inner = |block: usize| {
            let Range { start, end } = samples(block);
            start..end - 1
        };
        let step_m = tile.step_m as f32;
        let steepest = block_maxima(&squares, cells, Self::BLOCKS, inner);
        let slopes = steepest.iter().map(|square| square.max(0.0).sqrt() / step_m);
        Self {
            levels,
            slopes: slopes.collect(),
        }
    }

    /// A level's blocks, row by row from the south.
    pub fn level(&self, level: u32) -> &[f32] {
        &self.levels[level as usize]
    }

    /// Steepest slope of a block of level 0, metres a metre.
    pub fn slope(&self, column: usize, row: usize) -> f32 {
        self.slopes[row * Self::BLOCKS + column]
    }

    /// Steepest slope of the tile, metres a metre.
    pub fn max_slope(&self) -> f32 {
        self.slopes.iter().copied().fold(0.0, f32::max)
    }

    /// Highest ground of a block, metres.
    pub fn max(&self, level: u32, column: usize, row: usize) -> f32 {
        self.levels[level as usize][row * (Self::BLOCKS >> level) + column]
    }
}

/// The highest of each of `blocks` x `blocks` blocks of a square of values, by the rows or columns that a block has; what is not a number
/// does not count.
fn block_maxima(
    values: &[f32],
    side: usize,
    blocks: usize,
    range: impl Fn(usize) -> Range<usize>,
) -> Vec<f32> {
    let mut maxima = Vec::with_capacity(blocks * blocks);
    for block in 0..blocks {
        let mut columns = vec![f32::NEG_INFINITY; side];
        for row in range(block) {
            for (highest, &value) in columns.iter_mut().zip(&values[row * side..][..side]) {
                *highest = highest.max(value);
            }
        }
        let highest = |block| {
            columns[range(block)]
                .iter()
                .copied()
                .fold(f32::NEG_INFINITY, f32::max)
        };
        maxima.extend((0..blocks).map(highest));
    }
    maxima
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sample_of_a_block_is_above_its_bound_whatever_the_lattice() {
        for side in [2, 18, 65, 129, 513] {
            let tile = HeightTile {
                side,
                level: 0,
                step_m: 512.0 / (side - 1) as f64,
                heights: (0..side * side)
                    .map(|k| (k.wrapping_mul(2_654_435_761) % 1000) as f32)
                    .collect(),
            };
            let bounds = GroundBounds::from_heights(&tile);
            for level in 0..GroundBounds::LEVELS {
                let blocks = GroundBounds::BLOCKS >> level;
                for k in 0..4096 {
                    // A point anywhere, and the block that it lies in.
                    let (x, y) = ((k % 64) as f64 * 7.99 + 3.3, (k / 64) as f64 * 7.99 + 1.7);
                    let (x, y) = (x.min(511.9), y.min(511.9));
                    let block = |metres: f64| (metres / 512.0 * blocks as f64) as usize;
                    let height = tile.ground(x, y).unwrap_or(f64::INFINITY);
                    let bound = f64::from(bounds.max(level, block(x), block(y)));
                    assert!(
                        height <= bound + 1e-3,
                        "{side}, level {level}: {height} above {bound}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_slope_is_the_steepest_of_the_cells_that_a_block_touches() {
        for side in [18, 65, 129, 300] {
            let cells = side - 1;
            let step_m = 512.0 / cells as f64;
            // Level ground with one cell's corner raised, and one sample missing.
            let (at, hole) = ([cells / 3, cells / 2], 5 * side + 5);
            let mut heights = vec![10.0; side * side];
            heights[at[1] * side + at[0]] = 10.0 + step_m as f32;
            heights[hole] = f32::NAN;
            let bounds = GroundBounds::from_heights(&HeightTile {
                side,
                level: 0,
                step_m,
                heights,
            });
            for block in 0..GroundBounds::BLOCKS * GroundBounds::BLOCKS {
                let [column, row] = [block % GroundBounds::BLOCKS, block / GroundBounds::BLOCKS];
                let touches = |block: usize, sample: usize| {
                    let [from, to] =
                        [block, block + 1].map(|k| k as f64 * cells as f64 / GroundBounds::BLOCKS as f64);
                    from < sample as f64 + 1.0 && to > sample as f64 - 1.0
                };
                let is_steep = touches(column, at[0]) && touches(row, at[1]);
                let slope = if is_steep { f32::sqrt(2.0) } else { 0.0 };
                assert!(
                    (bounds.slope(column, row) - slope).abs() < 1e-5,
                    "{side} {column} {row}"
                );
            }
        }
    }
}
