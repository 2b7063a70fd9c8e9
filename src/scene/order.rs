//! Tiles in order of their distance from the eye (KR 10-0738500: occlusion between tiles).

use glam::DVec2;

use crate::space::{TileGrid, TileId};

/// Indices of `tiles`, the nearest first. Disjoint columns of one grid never hide each other in a cycle, so this order
/// is also the order along every ray.
pub fn nearest_first(grid: &TileGrid, tiles: &[TileId], eye: DVec2) -> Vec<usize> {
    let distance = |tile: TileId| grid.tile_bounds(tile).distance_to(eye);
    let mut order: Vec<(f64, usize)> = tiles
        .iter()
        .enumerate()
        .map(|(index, &tile)| (distance(tile), index))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order.into_iter().map(|(_, index)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tile_under_the_eye_comes_first_and_distance_grows() {
        let grid = TileGrid {
            west: 0.0,
            south: 0.0,
            tile_m: 10.0,
            columns: 5,
            rows: 5,
        };
        let tiles: Vec<TileId> = grid.tiles().collect();
        let order = nearest_first(&grid, &tiles, DVec2::new(23.0, 31.0));
        assert_eq!(tiles[order[0]], TileId { level: 0, x: 2, y: 3 });
        assert_eq!(order.len(), 25);
    }
}
