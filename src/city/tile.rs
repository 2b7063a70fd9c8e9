//! One tile of a city, whole: what an import writes, a reader reads, the device holds and rays walk.

use std::borrow::Borrow;

use glam::DVec2;

use super::ImageryTile;
use super::codec::TerrainTile;
use crate::buildings::{BuildingMap, MapTile};
use crate::space::{TileGrid, TileId};
use crate::terrain::{GroundBounds, HeightTile};

/// All layers of one tile.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Which.
    pub id: TileId,
    /// Heights and the meshes that carry them; none where the city has no ground.
    pub terrain: Option<TerrainTile>,
    /// Maxima of the ground.
    pub ground_bounds: Option<GroundBounds>,
    /// Building map and pyramid; none where no building stands.
    pub buildings: Option<MapTile>,
    /// Orthophoto; none where there is none.
    pub imagery: Option<ImageryTile>,
}

impl Tile {
    /// Puts the layers together: the one place where a tile's bounds and its pyramids are made.
    pub fn new(
        id: TileId,
        terrain: Option<TerrainTile>,
        map: Option<BuildingMap>,
        imagery: Option<ImageryTile>,
    ) -> Self {
        let ground = terrain.as_ref().and_then(|terrain| terrain.ground.range());
        let lowest = ground.map_or(f32::INFINITY, |[lowest, _]| lowest);
        let buildings = map.map(|map| MapTile::new(map.over_ground(lowest)));
        let ground_bounds = terrain
            .as_ref()
            .map(|terrain| GroundBounds::from_heights(&terrain.ground));
        Self {
            id,
            terrain,
            ground_bounds,
            buildings,
            imagery,
        }
    }

    /// True without any layer.
    pub fn is_empty(&self) -> bool {
        self.terrain.is_none() && self.buildings.is_none() && self.imagery.is_none()
    }
}

/// Ground at a point of the city, metres: point, then tile, then height. `heights` gives a tile's; none without ground.
pub fn ground_at<H: Borrow<HeightTile>, E>(
    grid: &TileGrid,
    point: DVec2,
    heights: impl FnOnce(TileId) -> Result<Option<H>, E>,
) -> Result<Option<f64>, E> {
    let Some(id) = grid.tile_at(point) else {
        return Ok(None);
    };
    let local = point - grid.origin(id);
    Ok(heights(id)?.and_then(|tile| tile.borrow().ground(local.x, local.y)))
}
