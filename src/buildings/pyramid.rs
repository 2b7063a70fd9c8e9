//! The pyramid of maxima over the roof elevations (+1/3 of the texels): what of a block a ray stays above is
//! skipped in one read (maximum mipmaps: Tevs, Ihrke & Seidel 2008).

use half::f16;

use super::BuildingMap;

/// Highest roof per block, metres; negative infinity where no building is.
#[derive(Clone, Debug)]
pub struct Pyramid {
    /// `levels[k]` has `side / 2^k` squared blocks of `2^k` texels, row by row from the south; the last has one.
    pub levels: Vec<Vec<f32>>,
}

impl Pyramid {
    /// Builds all levels above the texels.
    pub fn of(map: &BuildingMap) -> Self {
        let texels = (0..map.cells.len()).map(|cell| map.highest_roof(cell)).collect();
        let mut levels: Vec<Vec<f32>> = vec![texels];
        let mut side = map.side;
        while side > 1 {
            let below = &levels[levels.len() - 1];
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

    /// Highest roof of a block at `level` (0 = a texel, 1 = 2 x 2 texels).
    pub fn highest(&self, level: u32, column: i32, row: i32, side: usize) -> f32 {
        let blocks = side >> level;
        self.levels[level as usize][row as usize * blocks + column as usize]
    }

    /// Highest roofs of the quarters of every block at `level` (from 1), rows from the south: metres above `low`, rounded
    /// up to half floats. Where no building is, the least half float.
    pub fn quarters(&self, level: usize, low: f32) -> Vec<[f16; 4]> {
        let below = &self.levels[level - 1];
        let side = below.len().isqrt();
        let at = |column: usize, row: usize| match below[row * side + column] {
            f32::NEG_INFINITY => f16::MIN,
            highest => round_up((highest - low).max(0.0)),
        };
        (0..side / 2)
            .flat_map(|row| (0..side / 2).map(move |column| (2 * column, 2 * row)))
            .map(|(x, y)| [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)])
            .collect()
    }
}

/// The least half float that is no less than a value of at least 0.
fn round_up(value: f32) -> f16 {
    let near = f16::from_f32(value);
    if near.to_f32() < value {
        f16::from_bits(near.to_bits() + 1)
    } else {
        near
    }
}
