//! A tile's building map as rays walk it.

use super::{BuildingMap, DeviceMap, Pyramid};

/// A building map with its pyramid.
#[derive(Clone, Debug)]
pub struct MapTile {
    /// The map.
    pub map: BuildingMap,
    /// Its maxima.
    pub pyramid: Pyramid,
}

impl MapTile {
    /// Builds the pyramid.
    pub fn new(map: BuildingMap) -> Self {
        Self {
            pyramid: Pyramid::from_map(&map, map.height_range[0]),
            map,
        }
    }

    /// Bytes that a map takes on the device: words, and a length along the outline for every vertex; a record of 16 bytes for every
    /// vertex and occupied block, two for every roof where there are outlines, else one; its pyramid.
    pub fn bytes_of(map: &BuildingMap) -> u64 {
        let words = DeviceMap::word_count(map) + map.vertices.len();
        let records = map.vertices.len()
            + (1 + usize::from(map.has_outlines())) * map.roofs.len()
            + map.occupied_count();
        (4 * words + 16 * records + Pyramid::bytes(map.side)) as u64
    }
}
