//! Ground heights by point for an import and an update, from a city's own terrain tiles: what the map says of the ground
//! must follow from the city folder alone.

use std::collections::{HashMap, VecDeque};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use glam::DVec2;

use super::CityError;
use super::codec::{Lattice, read_heights};
use super::layer::Layer;
use super::tile::ground_at;
use crate::space::{TileGrid, TileId};
use crate::terrain::HeightTile;

/// Bytes of heights kept in memory.
const BUDGET_BYTES: usize = 192 << 20;

/// A cache of terrain tiles, shared by threads.
pub struct GroundCache {
    folder: PathBuf,
    grid: TileGrid,
    side: usize,
    step_m: f64,
    cache: Mutex<Cache>,
}

#[derive(Default)]
struct Cache {
    tiles: HashMap<TileId, Option<Arc<HeightTile>>>,
    order: VecDeque<TileId>,
}

impl GroundCache {
    /// Over the terrain tiles of a city folder.
    pub fn new(folder: PathBuf, grid: TileGrid, side: usize, step_m: f64) -> Self {
        Self {
            folder,
            grid,
            side,
            step_m,
            cache: Mutex::default(),
        }
    }

    /// Keeps a tile that was just made, `None` where there is no ground.
    pub fn keep(&self, tile: TileId, ground: Option<Arc<HeightTile>>) {
        let most = (BUDGET_BYTES / (4 * self.side * self.side)).max(4);
        let mut cache = self
            .cache
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        if cache.tiles.insert(tile, ground).is_none() {
            cache.order.push_back(tile);
        }
        while cache.order.len() > most {
            if let Some(oldest) = cache.order.pop_front() {
                cache.tiles.remove(&oldest);
            }
        }
    }

    /// A tile's heights.
    pub fn tile(&self, tile: TileId) -> Result<Option<Arc<HeightTile>>, CityError> {
        {
            let cache = self
                .cache
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            if let Some(known) = cache.tiles.get(&tile) {
                return Ok(known.clone());
            }
        }
        let path = Layer::Terrain.tile_path(&self.folder, tile);
        let ground = match path.exists() {
            true => Some(Arc::new(read_heights(
                &path,
                Lattice {
                    side: self.side,
                    step_m: self.step_m,
                    level: 0,
                    corner: {
                        let bounds = self.grid.tile_bounds(tile);
                        [bounds.west, bounds.north]
                    },
                },
            )?)),
            false => None,
        };
        self.keep(tile, ground.clone());
        Ok(ground)
    }

    /// Ground at a point of the city, metres.
    pub fn at(&self, x: f64, y: f64) -> Result<Option<f64>, CityError> {
        ground_at(&self.grid, DVec2::new(x, y), |id| self.tile(id))
    }
}
