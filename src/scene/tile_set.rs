//! The resident tiles on the CPU: what picking, the sun's visible fraction and the traversal's CPU twin ask. Never the disk.

use glam::{DVec2, IVec2};

use crate::buildings::MapTile;
use crate::city::ground_at;
use crate::space::{TileGrid, TileId};
use crate::terrain::{GroundBounds, HeightTile};

/// The ground of a tile as rays walk it.
#[derive(Clone, Debug)]
pub struct GroundTile {
    /// Heights.
    pub heights: HeightTile,
    /// Their maxima.
    pub bounds: GroundBounds,
}

/// A tile as rays walk it.
#[derive(Clone, Debug, Default)]
pub struct WalkTile {
    /// Its ground.
    pub ground: Option<GroundTile>,
    /// Its building map.
    pub buildings: Option<MapTile>,
}

/// The resident tiles of a city.
#[derive(Clone, Debug)]
pub struct TileSet {
    /// The tile grid.
    pub grid: TileGrid,
    /// Row by row from the south-west.
    tiles: Vec<WalkTile>,
    /// Highest roof, metres; negative infinity without buildings.
    pub max_roof: f32,
    /// Lowest ground of the tiles with buildings, metres; infinity without buildings.
    pub min_ground: f32,
    /// Highest ground, metres; negative infinity without ground.
    pub max_ground: f32,
}

impl TileSet {
    /// Nothing resident yet.
    pub fn new(grid: TileGrid) -> Self {
        let count = grid.columns as usize * grid.rows as usize;
        Self {
            grid,
            tiles: vec![WalkTile::default(); count],
            max_roof: f32::NEG_INFINITY,
            min_ground: f32::INFINITY,
            max_ground: f32::NEG_INFINITY,
        }
    }

    fn index(&self, id: TileId) -> usize {
        self.grid.columns as usize * id.y as usize + id.x as usize
    }

    /// Puts a tile of level 0.
    pub fn put(&mut self, id: TileId, tile: WalkTile) {
        if let Some(ground) = &tile.ground {
            let max = ground.bounds.max(GroundBounds::LEVELS - 1, 0, 0);
            self.max_ground = self.max_ground.max(max);
        }
        self.count_bounds(tile.buildings.as_ref());
        let index = self.index(id);
        if let Some(slot) = self.tiles.get_mut(index) {
            *slot = tile;
        }
    }

    fn count_bounds(&mut self, buildings: Option<&MapTile>) {
        if let Some(MapTile { pyramid, .. }) = buildings {
            self.max_roof = self.max_roof.max(pyramid.max_height());
            self.min_ground = self.min_ground.min(pyramid.min_height());
        }
    }

    /// Replaces building maps of tiles.
    pub fn replace_buildings(&mut self, maps: impl IntoIterator<Item = (TileId, Option<MapTile>)>) {
        for (id, map) in maps {
            let index = self.index(id);
            if let Some(slot) = self.tiles.get_mut(index) {
                slot.buildings = map;
            }
        }
        (self.max_roof, self.min_ground) = (f32::NEG_INFINITY, f32::INFINITY);
        let tiles = std::mem::take(&mut self.tiles);
        for tile in &tiles {
            self.count_bounds(tile.buildings.as_ref());
        }
        self.tiles = tiles;
    }

    /// A tile of level 0.
    pub fn tile(&self, id: TileId) -> Option<&WalkTile> {
        self.tiles.get(self.index(id))
    }

    /// The tile in a column and row, none outside the grid.
    pub fn at(&self, position: IVec2) -> Option<&WalkTile> {
        let inside = |value: i32, count: u32| u32::try_from(value).is_ok_and(|value| value < count);
        if !inside(position.x, self.grid.columns) || !inside(position.y, self.grid.rows) {
            return None;
        }
        let [x, y] = [position.x, position.y].map(|value| value as usize);
        self.tiles.get(y * self.grid.columns as usize + x)
    }

    /// Ground at a point of the city, metres; none where there is none.
    pub fn ground_at(&self, point: DVec2) -> Option<f64> {
        let heights = |id: TileId| {
            Ok::<_, std::convert::Infallible>(
                self.tile(id)
                    .and_then(|tile| Some(&tile.ground.as_ref()?.heights)),
            )
        };
        let Ok(height) = ground_at(&self.grid, point, heights);
        height
    }
}
