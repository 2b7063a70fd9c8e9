//! The pyramid of maxima over a tile's ground: rays to the sun pass what they stay above of in one read, as they pass roofs
//! (maximum mipmaps: Tevs, Ihrke & Seidel 2008).

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
            first..=last.min(cells)
        };
        let max = |values: &mut dyn Iterator<Item = f32>| values.fold(f32::NEG_INFINITY, f32::max);
        let blocks = 0..Self::BLOCKS * Self::BLOCKS;
        let finest = blocks
            .map(|k| {
                let (column, row) = (k % Self::BLOCKS, k / Self::BLOCKS);
                max(&mut samples(row)
                    .flat_map(|j| samples(column).map(move |i| j * tile.side + i))
                    .map(|sample| tile.heights[sample])
                    .filter(|height| height.is_finite()))
            })
            .collect();
        let mut levels: Vec<Vec<f32>> = vec![finest];
        for level in 1..Self::LEVELS {
            let side = Self::BLOCKS >> level;
            let below = &levels[level as usize - 1];
            let coarser = (0..side * side)
                .map(|k| {
                    let first = 2 * (k / side) * 2 * side + 2 * (k % side);
                    max(&mut [first, first + 1, first + 2 * side, first + 2 * side + 1]
                        .into_iter()
                        .map(|child| below[child]))
                })
                .collect();
            levels.push(coarser);
        }
        let step_m = tile.step_m as f32;
        // The gradient of a bilinear cell is no steeper than its steepest edges together.
        let cell_slope = |i: usize, j: usize| {
            let at = |di: usize, dj: usize| tile.heights[(j + dj) * tile.side + i + di];
            let edge = |a: f32, b: f32| (b - a).abs();
            let east = edge(at(0, 0), at(1, 0)).max(edge(at(0, 1), at(1, 1)));
            let north = edge(at(0, 0), at(0, 1)).max(edge(at(1, 0), at(1, 1)));
            east.hypot(north) / step_m
        };
        let slopes = (0..Self::BLOCKS * Self::BLOCKS)
            .map(|k| {
                let inner = |block: usize| samples(block).take_while(|&sample| sample < cells);
                let (columns, rows) = (k % Self::BLOCKS, k / Self::BLOCKS);
                max(&mut inner(rows)
                    .flat_map(|j| inner(columns).map(move |i| (i, j)))
                    .map(|(i, j)| cell_slope(i, j))
                    .filter(|slope| slope.is_finite()))
                .max(0.0)
            })
            .collect();
        Self { levels, slopes }
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
}
