//! Which parts of the levels a view sees: of others nobody asks where streets run.

use glam::DVec2;

use super::{STREET_CELLS, STREET_LEVELS, level_cell_m};
use crate::scene::Frustum;
use crate::space::Bounds;

/// Cells along a side of a block that is seen or not; blocks along a level's side.
pub const BLOCK_CELLS: usize = 64;
const BLOCKS: usize = STREET_CELLS.div_ceil(BLOCK_CELLS);
/// Cells round a block that count as its own: those that its last ones are interpolated with, or evened out.
const GROWN: f64 = 4.0;
const _: () = assert!(BLOCKS * BLOCKS <= u128::BITS as usize);

/// Blocks, a bit each, level by level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SeenBlocks([u128; STREET_LEVELS]);

impl SeenBlocks {
    /// Every block.
    pub const ALL: Self = Self([u128::MAX; STREET_LEVELS]);

    /// Those of the levels round a centre that a view sees, of ground and roofs between two heights.
    pub fn from_view(frustum: &Frustum, centre: DVec2, [low, high]: [f64; 2]) -> Self {
        Self(std::array::from_fn(|level| {
            let cell_m = level_cell_m(level);
            let corner = centre - 0.5 * STREET_CELLS as f64 * cell_m;
            let is_seen = |block: &usize| {
                let first = DVec2::new((block % BLOCKS) as f64, (block / BLOCKS) as f64) * BLOCK_CELLS as f64;
                let from = corner + (first - GROWN) * cell_m;
                let to = corner + (first + BLOCK_CELLS as f64 + GROWN) * cell_m;
                let bounds = Bounds {
                    west: from.x,
                    south: from.y,
                    east: to.x,
                    north: to.y,
                };
                frustum.sees(&bounds, low, high)
            };
            let seen = (0..BLOCKS * BLOCKS).filter(is_seen);
            seen.fold(0, |bits, block| bits | 1 << block)
        }))
    }

    /// Whether any block of a level is one.
    pub fn any(&self, level: usize) -> bool {
        self.0[level] != 0
    }

    /// Whether a cell's block is one.
    pub fn has(&self, level: usize, [column, row]: [usize; 2]) -> bool {
        let block = row / BLOCK_CELLS * BLOCKS + column / BLOCK_CELLS;
        self.0[level] & (1 << block) != 0
    }

    /// Whether all of another's are among them.
    pub fn covers(&self, other: &Self) -> bool {
        self.0.iter().zip(other.0).all(|(own, other)| other & !own == 0)
    }
}
