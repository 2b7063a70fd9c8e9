//! Site coverage: which part of the ground near a place buildings stand on, for what the ground looks like between them. From the resident
//! building maps, so that it follows an update.

use super::SceneError;
use super::tile_set::{TILE_SQUARES, TileSet};
use crate::gpu::{Gpu, LayerPool};
use crate::space::{TileGrid, TileId};

/// Squares of a city at most.
const MAX_SQUARES: u64 = 1 << 20;
/// Radius of the tent that a square's mean is taken by, squares of [`TILE_SQUARES`]: about 100 m for tiles of 512 m.
const RADIUS: usize = 2;

/// The coverage of the whole city.
pub struct SiteCoverage {
    /// One layer, 1 where all is covered; rows from the south.
    pub image: LayerPool,
    /// Squares along a tile's side: [`TILE_SQUARES`], fewer in a city of more than [`MAX_SQUARES`].
    squares: usize,
    /// Columns and rows of squares.
    size: [usize; 2],
    /// Of each square alone, 0 to 255, row by row from the south.
    covered: Vec<u8>,
}

impl SiteCoverage {
    /// Of a grid without buildings.
    ///
    /// # Errors
    /// When the device cannot hold it.
    pub fn new(gpu: &Gpu, grid: &TileGrid) -> Result<Self, SceneError> {
        let tiles = [grid.columns, grid.rows].map(u64::from);
        let side = u64::from(gpu.device.limits().max_texture_dimension_2d);
        let fits = |&squares: &usize| {
            let [columns, rows] = tiles.map(|count| count * squares as u64);
            columns.max(rows) <= side && columns * rows <= MAX_SQUARES
        };
        let halved = std::iter::successors(Some(TILE_SQUARES), |squares| Some(squares / 2));
        let squares = halved.take_while(|&squares| squares > 1).find(fits).unwrap_or(1);
        let size = tiles.map(|count| count as usize * squares);
        let format = wgpu::TextureFormat::R8Unorm;
        let mut image = LayerPool::new(gpu, "site coverage", format, size.map(|count| count as u32), 1)?;
        image.reserve(gpu, 1)?;
        Ok(Self {
            image,
            squares,
            size,
            covered: vec![0; size[0] * size[1]],
        })
    }

    /// Takes over what stands in the tile table.
    pub fn update(&mut self, gpu: &Gpu, tiles: &TileSet) {
        let mut covered = vec![0; self.covered.len()];
        for (id, of_tile) in tiles.standing_coverage() {
            self.fill(&mut covered, id, of_tile);
        }
        if covered != self.covered {
            self.covered = covered;
            let radius = (RADIUS * self.squares / TILE_SQUARES).max(1);
            self.image
                .write(gpu, 0, 0, &smoothed(&self.covered, self.size, radius));
        }
    }

    /// Enters what a tile covers, given by `TILE_SQUARES` along its side.
    fn fill(&self, covered: &mut [u8], id: TileId, of_tile: &[u8]) {
        let side = self.squares << id.level;
        let first = [id.x, id.y].map(|index| index as usize * side);
        // Entries of the tile that lie in a square of the city, or one that several squares lie in.
        let per = (TILE_SQUARES / side).max(1);
        let mean = |x: usize, y: usize| {
            let [column, row] = [x, y].map(|k| k * TILE_SQUARES / side);
            let rows = of_tile.chunks_exact(TILE_SQUARES).skip(row).take(per);
            let sum: u32 = rows
                .flat_map(|row| &row[column..column + per])
                .map(|&part| u32::from(part))
                .sum();
            (sum / (per * per) as u32) as u8
        };
        for y in 0..side.min(self.size[1].saturating_sub(first[1])) {
            let row = &mut covered[(first[1] + y) * self.size[0]..][..self.size[0]];
            for (x, square) in row[first[0].min(self.size[0])..]
                .iter_mut()
                .take(side)
                .enumerate()
            {
                *square = mean(x, y);
            }
        }
    }
}

/// The mean of each square and those round it, by a tent of `radius` squares on each side.
fn smoothed(values: &[u8], [columns, rows]: [usize; 2], radius: usize) -> Vec<u8> {
    let weights: Vec<u32> = (0..=2 * radius)
        .map(|k| (radius + 1 - k.abs_diff(radius)) as u32)
        .collect();
    let total = weights.iter().sum::<u32>();
    let add = |sums: &mut [u32], values: &[u32], weight: u32| {
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += weight * value;
        }
    };
    let wide: Vec<u32> = values.iter().map(|&value| u32::from(value)).collect();
    let mut across = vec![0; columns * rows];
    for (sums, row) in across.chunks_exact_mut(columns).zip(wide.chunks_exact(columns)) {
        for (k, &weight) in weights.iter().enumerate() {
            // What lies k - radius squares to the east; beyond the city nothing stands.
            let (from, to) = (
                k.saturating_sub(radius).min(columns),
                radius.saturating_sub(k).min(columns),
            );
            add(&mut sums[to..], &row[from..], weight);
        }
    }
    let mut up = vec![0; columns * rows];
    for (y, sums) in up.chunks_exact_mut(columns).enumerate() {
        for (k, &weight) in weights.iter().enumerate() {
            let row = (y + k).checked_sub(radius).filter(|row| *row < rows);
            if let Some(row) = row {
                add(sums, &across[row * columns..][..columns], weight);
            }
        }
    }
    up.into_iter().map(|sum| (sum / (total * total)) as u8).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_keeps_the_sum_and_reaches_no_farther_than_it_should() {
        let size = [9, 7];
        let mut values = vec![0; 63];
        values[3 * 9 + 4] = 162;
        let means = smoothed(&values, size, 2);
        // The tent's weights in the middle: 3 x 3 of 81.
        assert_eq!(means[3 * 9 + 4], 18);
        assert_eq!(means.iter().map(|&mean| u32::from(mean)).sum::<u32>(), 162);
        let reached = |k: usize| (k / 9).abs_diff(3) <= 2 && (k % 9).abs_diff(4) <= 2;
        assert!((0..63).all(|k| (means[k] > 0) == reached(k)));
    }
}
