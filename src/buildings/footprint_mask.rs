//! Which ground of a tile buildings stand on: a bit for every 2 x 2 texels of its map, for those who ask what lies between buildings.

use super::cell::{CellKind, Full};
use super::map::{BLOCK, BuildingMap};

/// Texels along a cell's side.
const CELL_TEXELS: usize = 2;
/// What a whole texel covers, and what a cell has of that at least where it is taken for covered. A texel that an outline crosses counts
/// half.
const WHOLE: u32 = 2 * Full::WHOLE;
const COVERED: u32 = WHOLE * (CELL_TEXELS * CELL_TEXELS) as u32 / 2;

/// Bits row by row from the south, a row in whole words.
#[derive(Clone, Debug, PartialEq)]
pub struct FootprintMask {
    side: usize,
    bits: Vec<u64>,
}

impl FootprintMask {
    /// Of a building map.
    pub fn from_map(map: &BuildingMap) -> Self {
        let mut mask = Self::empty((map.side / CELL_TEXELS).max(1));
        for ([column, row], block) in map.blocks() {
            let covers = map.codes_in(block).map(covered_part);
            let cells = BLOCK / CELL_TEXELS;
            for cell in 0..cells * cells {
                let [x, y] = [cell % cells, cell / cells];
                let first = CELL_TEXELS * (y * BLOCK + x);
                let texels =
                    (0..CELL_TEXELS * CELL_TEXELS).map(|k| first + k / CELL_TEXELS * BLOCK + k % CELL_TEXELS);
                if texels.map(|texel| covers[texel]).sum::<u32>() >= COVERED {
                    mask.cover(column * cells + x, row * cells + y);
                }
            }
        }
        mask
    }

    /// Of cells that are covered by a rule.
    #[cfg(test)]
    pub fn from_cells(side: usize, is_covered: impl Fn(usize, usize) -> bool) -> Self {
        let mut mask = Self::empty(side);
        for cell in 0..side * side {
            let [x, y] = [cell % side, cell / side];
            if is_covered(x, y) {
                mask.cover(x, y);
            }
        }
        mask
    }

    fn empty(side: usize) -> Self {
        Self {
            side,
            bits: vec![0; side * Self::words_across(side)],
        }
    }

    fn words_across(side: usize) -> usize {
        side.div_ceil(u64::BITS as usize)
    }

    fn cover(&mut self, x: usize, y: usize) {
        let across = Self::words_across(self.side);
        if x < self.side && y < self.side {
            self.bits[y * across + x / 64] |= 1 << (x % 64);
        }
    }

    /// Cells along a side.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Whether a building stands on a cell; none stands beyond the tile.
    pub fn is_covered(&self, x: usize, y: usize) -> bool {
        let word = self.bits.get(y * Self::words_across(self.side) + x / 64);
        x < self.side && word.is_some_and(|word| word & (1 << (x % 64)) != 0)
    }
}

/// What a texel of a code covers, of [`WHOLE`].
fn covered_part(code: u32) -> u32 {
    match CellKind::from_code(code) {
        CellKind::Empty => 0,
        CellKind::Full(full) => 2 * full.coverage,
        _ => WHOLE / 2,
    }
}
