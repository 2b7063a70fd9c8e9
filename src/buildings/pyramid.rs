//! The pyramid of maxima over the roof elevations (+1/3 of the texels): a ray that stays above a block's
//! highest roof skips the block in one read (maximum mipmaps: Tevs, Ihrke & Seidel 2008).

use super::BuildingMap;

/// Highest roof per block, metres; negative infinity where no building is.
#[derive(Clone, Debug)]
pub struct Pyramid {
    /// `levels[k]` has `side / 2^(k+1)` squared blocks of `2^(k+1)` texels, row by row from the south; the last
    /// has one.
    pub levels: Vec<Vec<f32>>,
}

impl Pyramid {
    /// Builds all levels above the texels.
    pub fn of(map: &BuildingMap) -> Self {
        let texels: Vec<f32> = (0..map.cells.len()).map(|cell| map.highest_roof(cell)).collect();
        let mut levels: Vec<Vec<f32>> = Vec::new();
        let mut side = map.side;
        while side > 1 {
            let below = levels.last().unwrap_or(&texels);
            let half = side / 2;
            let mut level = Vec::with_capacity(half * half);
            for row in 0..half {
                for column in 0..half {
                    let at = |di: usize, dj: usize| below[(2 * row + dj) * side + 2 * column + di];
                    level.push(at(0, 0).max(at(1, 0)).max(at(0, 1)).max(at(1, 1)));
                }
            }
            levels.push(level);
            side = half;
        }
        Self { levels }
    }

    /// Highest roof of the tile.
    pub fn top(&self) -> f32 {
        self.levels.last().map_or(f32::NEG_INFINITY, |level| level[0])
    }

    /// Highest roof of a block at `level` (1 = 2 x 2 texels).
    pub fn highest(&self, level: u32, column: i32, row: i32, side: usize) -> f32 {
        let blocks = side >> level;
        self.levels[level as usize - 1][row as usize * blocks + column as usize]
    }
}
