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
    /// Builds the pyramid. `lowest_ground` is the tile's, metres; the tile's lower bound is that or the lowest base of its
    /// buildings, whichever is lower.
    pub fn new(map: BuildingMap, lowest_ground: Option<f32>) -> Self {
        let min_height = lowest_ground.unwrap_or(f32::INFINITY).min(map.lowest_base());
        Self {
            pyramid: Pyramid::from_map(&map, min_height),
            map,
        }
    }
}
