//! The resident tiles on the CPU: what picking, the sun's visible fraction and the traversal's CPU twin ask. Never the disk.

use std::sync::Arc;

use glam::{DVec2, IVec2};

use super::tile_table::{TileTable, level_and_slot};
use super::{MAPS, TERRAIN};
use crate::buildings::{FootprintMask, MapTile, Pyramid};
use crate::space::{TileGrid, TileId};
use crate::terrain::{GroundBounds, HeightTile};

/// Squares along a tile's side of which it is known what buildings cover.
pub const TILE_SQUARES: usize = 16;

/// The ground of a tile as rays walk it.
#[derive(Clone, Debug)]
pub struct GroundTile {
    /// Heights.
    pub heights: HeightTile,
    /// Their maxima.
    pub bounds: GroundBounds,
}

/// The resident tiles of a city, by their slots.
#[derive(Clone, Debug)]
pub struct TileSet {
    /// The tile grid.
    pub grid: TileGrid,
    /// Which tile stands for which.
    pub table: TileTable,
    maps: Vec<Option<MapTile>>,
    grounds: Vec<Option<GroundTile>>,
    /// What stands before the sun, also where no rays are cast.
    roofs: Vec<Option<Arc<Pyramid>>>,
    /// Where buildings stand.
    footprints: Vec<Option<Arc<FootprintMask>>>,
    /// The part that buildings cover, by `TILE_SQUARES` along a tile's side.
    coverage: Vec<Option<Vec<u8>>>,
    ground_bounds: Vec<Option<Arc<GroundBounds>>>,
    /// The tiles that stand in the table, with their slots, by layer.
    pub(super) covers: [Vec<(TileId, u32)>; 3],
    /// Bounds of the whole city, metres.
    pub bounds: CityBounds,
}

/// Heights that no tile of the city goes beyond, metres; infinite without any.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CityBounds {
    /// Highest roof.
    pub max_roof: f32,
    /// Lowest ground under buildings.
    pub min_ground: f32,
    /// Highest ground.
    pub max_ground: f32,
}

impl Default for CityBounds {
    fn default() -> Self {
        Self {
            max_roof: f32::NEG_INFINITY,
            min_ground: f32::INFINITY,
            max_ground: f32::NEG_INFINITY,
        }
    }
}

impl CityBounds {
    /// Lowest and highest surface, metres; 0 without any.
    pub fn heights(&self) -> [f64; 2] {
        let surfaces = [
            self.min_ground.min(self.max_ground),
            self.max_roof.max(self.max_ground),
        ];
        surfaces.map(|height| {
            if height.is_finite() {
                f64::from(height)
            } else {
                0.0
            }
        })
    }
}

impl TileSet {
    /// Nothing resident yet.
    pub fn new(grid: TileGrid) -> Self {
        Self {
            grid,
            table: TileTable::new(grid),
            maps: Vec::new(),
            grounds: Vec::new(),
            roofs: Vec::new(),
            footprints: Vec::new(),
            coverage: Vec::new(),
            ground_bounds: Vec::new(),
            covers: [const { Vec::new() }; 3],
            bounds: CityBounds::default(),
        }
    }

    /// Puts a building map into its slot; none empties it.
    pub fn put_map(&mut self, slot: u32, map: Option<MapTile>) {
        put(&mut self.maps, slot, map);
    }

    /// Puts ground into its slot; none empties it.
    pub fn put_ground(&mut self, slot: u32, ground: Option<GroundTile>) {
        put(&mut self.grounds, slot, ground);
    }

    /// Puts the highest roofs of a building map into its slot; none empties it.
    pub fn put_roofs(&mut self, slot: u32, roofs: Option<Pyramid>) {
        let coverage = roofs.as_ref().map(|roofs| roofs.coverage(TILE_SQUARES));
        put(&mut self.coverage, slot, coverage);
        put(&mut self.roofs, slot, roofs.map(Arc::new));
    }

    /// Puts where the buildings of a map stand into its slot; none empties it.
    pub fn put_footprints(&mut self, slot: u32, footprints: Option<FootprintMask>) {
        put(&mut self.footprints, slot, footprints.map(Arc::new));
    }

    /// Puts bounds of ground into their slot; none empties it.
    pub fn put_ground_bounds(&mut self, slot: u32, bounds: Option<GroundBounds>) {
        put(&mut self.ground_bounds, slot, bounds.map(Arc::new));
    }

    /// The tiles that stand in the table: the highest roofs of each building map.
    pub fn standing_roofs(&self) -> impl Iterator<Item = (TileId, Arc<Pyramid>)> {
        let roofs = |&(id, slot): &(TileId, u32)| Some((id, self.roofs.get(slot as usize)?.clone()?));
        self.covers[MAPS].iter().filter_map(roofs)
    }

    /// The tiles that stand in the table: where the buildings of each stand.
    pub fn standing_footprints(&self) -> impl Iterator<Item = (TileId, Arc<FootprintMask>)> {
        let footprints =
            |&(id, slot): &(TileId, u32)| Some((id, self.footprints.get(slot as usize)?.clone()?));
        self.covers[MAPS].iter().filter_map(footprints)
    }

    /// The tiles that stand in the table: what buildings cover of each.
    pub fn standing_coverage(&self) -> impl Iterator<Item = (TileId, &[u8])> {
        let covered = |&(id, slot): &(TileId, u32)| Some((id, self.coverage.get(slot as usize)?.as_deref()?));
        self.covers[MAPS].iter().filter_map(covered)
    }

    /// The tiles that stand in the table: the bounds of each one's ground.
    pub fn standing_ground(&self) -> impl Iterator<Item = (TileId, Arc<GroundBounds>)> {
        let bounds =
            |&(id, slot): &(TileId, u32)| Some((id, self.ground_bounds.get(slot as usize)?.clone()?));
        self.covers[TERRAIN].iter().filter_map(bounds)
    }

    /// Level and map of the tile that stands for a tile of the grid.
    pub fn map_over(&self, tile: IVec2) -> (u32, Option<&MapTile>) {
        let (level, slot) = level_and_slot(self.table.at(tile)[MAPS]);
        (
            level,
            slot.and_then(|slot| self.maps.get(slot as usize)?.as_ref()),
        )
    }

    /// Level and ground of the tile that stands for a tile of the grid.
    pub fn ground_over(&self, tile: IVec2) -> (u32, Option<&GroundTile>) {
        let (level, slot) = level_and_slot(self.table.at(tile)[TERRAIN]);
        (
            level,
            slot.and_then(|slot| self.grounds.get(slot as usize)?.as_ref()),
        )
    }

    /// Level and slot of the terrain that stands for a tile of the grid.
    pub fn ground_slot_over(&self, tile: IVec2) -> (u32, Option<u32>) {
        level_and_slot(self.table.at(tile)[TERRAIN])
    }

    /// Ground at a point of the city, metres; none where there is none.
    pub fn ground_at(&self, point: DVec2) -> Option<f64> {
        let id = self.grid.tile_at(point)?;
        let (level, ground) = self.ground_over(IVec2::new(id.x as i32, id.y as i32));
        let first = [id.x, id.y].map(|index| f64::from((index >> level) << level));
        let corner =
            DVec2::new(self.grid.west, self.grid.south) + DVec2::from_array(first) * self.grid.tile_m;
        let local = point - corner;
        ground?.heights.ground(local.x, local.y)
    }
}

fn put<T>(slots: &mut Vec<Option<T>>, slot: u32, value: Option<T>) {
    if slots.len() <= slot as usize {
        slots.resize_with(slot as usize + 1, || None);
    }
    slots[slot as usize] = value;
}
