//! What stands before the sun: the highest roofs and ground of the tiles in the table, held apart from them so that bounds can be made
//! beside the frames.

use std::sync::Arc;

use glam::IVec2;

use crate::buildings::Pyramid;
use crate::scene::TileSet;
use crate::space::{TileGrid, TileId};
use crate::terrain::GroundBounds;

/// Roofs and ground of the resident city at one moment.
#[derive(Clone, Debug)]
pub struct SunObstacles {
    /// The tile grid.
    pub grid: TileGrid,
    /// Highest roofs.
    pub roofs: Vec<(TileId, Arc<Pyramid>)>,
    /// Highest ground, and on which sides of the tile (south, east, north, west) another level or nothing begins: the ground may have
    /// a step there.
    pub ground: Vec<(TileId, Arc<GroundBounds>, [bool; 4])>,
}

impl SunObstacles {
    /// Of the tiles that stand in the table.
    pub fn of(tiles: &TileSet) -> Self {
        let stepped = |(id, ground)| (id, ground, stepped_sides(tiles, id));
        Self {
            grid: tiles.grid,
            roofs: tiles.standing_roofs().collect(),
            ground: tiles.standing_ground().map(stepped).collect(),
        }
    }
}

fn stepped_sides(tiles: &TileSet, id: TileId) -> [bool; 4] {
    let (level, size) = (id.level, 1_i32 << id.level);
    let first = [(id.x << level) as i32, (id.y << level) as i32];
    let is_other = |x: i32, y: i32| {
        let (other, slot) = tiles.ground_slot_over(IVec2::new(x, y));
        slot.is_some() && other != level
    };
    let any = |at: &dyn Fn(i32) -> [i32; 2]| {
        (0..size).any(|k| {
            let [x, y] = at(k);
            is_other(x, y)
        })
    };
    let [x, y] = first;
    [
        any(&|k| [x + k, y - 1]),
        any(&|k| [x + size, y + k]),
        any(&|k| [x + k, y + size]),
        any(&|k| [x - 1, y + k]),
    ]
}
