//! A tile's building map as rays walk it.

use super::{BuildingMap, Pyramid};

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

    /// Bytes that a map takes on the device, pyramid included.
    pub fn bytes_of(map: &BuildingMap) -> u64 {
        (map.bytes() + Pyramid::bytes(map.side)) as u64
    }
}
