//! A building-map tile before and after an update.

use crate::buildings::{BuildingMap, MapTile};
use crate::city::{City, Layer};
use crate::space::TileId;

/// A tile that becomes another one.
pub struct TileChange {
    /// Which.
    pub id: TileId,
    /// Bytes of its map when loaded; 0 without one.
    pub bytes_before: u64,
    /// Whether its file was there.
    pub was_there: bool,
    /// Its new map; none where no building stands any more.
    pub map: Option<BuildingMap>,
}

impl TileChange {
    /// From one map to another; none when they are the same and the file is there or not accordingly.
    pub fn between(
        city: &City,
        id: TileId,
        before: Option<BuildingMap>,
        map: Option<BuildingMap>,
    ) -> Option<Self> {
        let was_there = city.has(Layer::Buildings, id);
        let is_same = before == map && was_there == map.is_some();
        (!is_same).then(|| Self {
            id,
            bytes_before: before.as_ref().map_or(0, MapTile::bytes_of),
            was_there,
            map,
        })
    }

    /// Bytes of the new map when loaded.
    pub fn bytes(&self) -> u64 {
        self.map.as_ref().map_or(0, MapTile::bytes_of)
    }
}
