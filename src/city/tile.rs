//! One tile of a city: how its ground is asked.

use std::borrow::Borrow;

use glam::DVec2;

use crate::space::{TileGrid, TileId};
use crate::terrain::HeightTile;

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
