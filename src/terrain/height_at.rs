//! Point to tile to height: the one way to ask a city's ground.

use std::borrow::Borrow;

use glam::DVec2;

use super::HeightTile;
use crate::space::{TileGrid, TileId};

/// Ground under a point of the city (its CRS, metres), by the heights that `tile` gives for a level-0 tile; none outside
/// the grid and where there is no ground.
///
/// # Errors
/// What `tile` fails with.
pub fn height_at<T: Borrow<HeightTile>, E>(
    grid: &TileGrid,
    point: DVec2,
    tile: impl FnOnce(TileId) -> Result<Option<T>, E>,
) -> Result<Option<f64>, E> {
    let Some(id) = grid.tile_at(point) else {
        return Ok(None);
    };
    let local = point - grid.origin(id);
    Ok(tile(id)?.and_then(|tile| tile.borrow().ground(local.x, local.y)))
}
