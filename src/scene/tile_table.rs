//! The tile table: for every tile of the grid, which resident tile stands for it in each layer (`shaders/lib/tile_table.wgsl`).

use glam::IVec2;

use crate::space::{TileGrid, TileId};

/// Bits below the level in a code; shaders have it as `TABLE_LEVEL_SHIFT`.
pub const TABLE_LEVEL_SHIFT: u32 = 20;

/// A code: slot and one more, or 0 where nothing is; from [`TABLE_LEVEL_SHIFT`] on the level.
pub fn table_code(level: u32, slot: Option<u32>) -> u32 {
    (level << TABLE_LEVEL_SHIFT) | slot.map_or(0, |slot| slot + 1)
}

/// Level and slot of a code.
pub fn level_and_slot(code: u32) -> (u32, Option<u32>) {
    let slot = (code & ((1 << TABLE_LEVEL_SHIFT) - 1)).checked_sub(1);
    (code >> TABLE_LEVEL_SHIFT, slot)
}

/// Codes of building map, imagery and terrain, and where the record of the building map lies.
#[derive(Clone, Debug)]
pub struct TileTable {
    grid: TileGrid,
    /// Row by row from the south-west.
    codes: Vec<[u32; 4]>,
}

impl TileTable {
    /// Of a grid of which nothing is resident.
    pub fn new(grid: TileGrid) -> Self {
        Self {
            grid,
            codes: vec![[0; 4]; grid.columns as usize * grid.rows as usize],
        }
    }

    /// The codes of a tile of the grid; nothing outside.
    pub fn at(&self, tile: IVec2) -> [u32; 4] {
        let inside = |value: i32, count: u32| u32::try_from(value).is_ok_and(|value| value < count);
        if !inside(tile.x, self.grid.columns) || !inside(tile.y, self.grid.rows) {
            return [0; 4];
        }
        self.codes[tile.y as usize * self.grid.columns as usize + tile.x as usize]
    }

    /// Lets a tile stand for all tiles of the grid under it in one layer.
    pub fn fill(&mut self, layer: usize, id: TileId, code: u32) {
        let columns = (id.x << id.level)..((id.x + 1) << id.level).min(self.grid.columns);
        for row in (id.y << id.level)..((id.y + 1) << id.level).min(self.grid.rows) {
            for column in columns.clone() {
                self.codes[(row * self.grid.columns + column) as usize][layer] = code;
            }
        }
    }

    /// All codes.
    pub fn codes(&self) -> &[[u32; 4]] {
        &self.codes
    }
}
