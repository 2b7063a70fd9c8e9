//! An eye on the tile grid: large coordinates end here, in f64.

use glam::{DVec3, IVec2, Vec2};

use crate::space::TileGrid;

/// A tile, metres within it, and a height: what eye-relative f32 coordinates count from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridPosition {
    /// Column and row; may lie outside the grid.
    pub tile: IVec2,
    /// Metres from the tile's south-west corner.
    pub in_tile: Vec2,
    /// Metres above the vertical datum.
    pub elevation: f32,
}

impl GridPosition {
    /// Of a point in the city's CRS, metres.
    pub fn new(grid: &TileGrid, point: DVec3) -> Self {
        let position = grid.position(point.truncate());
        let tile = position.floor();
        Self {
            tile: tile.as_ivec2(),
            in_tile: ((position - tile) * grid.tile_m).as_vec2(),
            elevation: point.z as f32,
        }
    }

    /// The tile under a point, metres from here.
    pub fn tile_at(&self, grid: &TileGrid, plan: Vec2) -> IVec2 {
        self.tile + ((self.in_tile + plan) / grid.tile_m as f32).floor().as_ivec2()
    }

    /// South-west corner of a tile, metres from here.
    pub fn tile_corner(&self, grid: &TileGrid, tile: IVec2) -> Vec2 {
        (tile - self.tile).as_vec2() * grid.tile_m as f32 - self.in_tile
    }
}
