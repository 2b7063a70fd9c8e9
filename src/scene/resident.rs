//! A city's tiles made resident: on the GPU for drawing, on the CPU for rays.

use std::time::SystemTime;

use glam::DVec2;
use rayon::prelude::*;

use super::SceneError;
use super::ground_tiles::{GroundTiles, GroundUpload, TerrainMesh};
use super::imagery_tiles::ImageryTiles;
use super::map_tiles::{MapTiles, MapUpload};
use super::tile_set::{GroundTile, TileSet, WalkTile};
use crate::city::{City, CityError, Layer, Tile};
use crate::gpu::{Gpu, filled_texture};
use crate::space::{TileGrid, TileId};

/// A resident city.
pub struct Resident {
    /// The tiles on the CPU.
    pub tiles: TileSet,
    /// Side of a texel, metres.
    pub texel_m: f64,
    /// Texels along a tile's side.
    pub tile_texels: u32,
    /// Distance between terrain samples, metres.
    pub terrain_step_m: f64,
    /// Terrain samples along a tile's side.
    pub terrain_side: u32,
    /// Per grid tile: building slot, imagery layer, terrain layer, 0; -1 = none.
    pub tile_table: wgpu::TextureView,
    /// The same, as uploaded.
    table: Vec<[i32; 4]>,
    /// What tells whether an update wrote a tile's building map.
    stamps: Vec<Option<(SystemTime, u64)>>,
    /// Ground.
    pub ground: GroundTiles,
    /// Building maps.
    pub maps: MapTiles,
    /// Imagery.
    pub imagery: ImageryTiles,
}

/// Tiles read in parallel at a time: bounds the memory beside the GPU's.
const BATCH: usize = 32;
/// No tile, in the tile table.
const NONE: i32 = -1;

impl Resident {
    /// Loads every tile.
    ///
    /// # Errors
    /// When a tile is damaged or missing, or the device cannot hold them all.
    pub fn load(gpu: &Gpu, city: &City, mesh: TerrainMesh) -> Result<Self, SceneError> {
        city.require_all_tiles()?;
        let manifest = city.manifest();
        let ids: Vec<TileId> = manifest.grid.tiles().collect();
        let stamps = ids.iter().map(|&id| city.stamp(Layer::Buildings, id)).collect();
        let count = |layer| manifest.tile_count(layer) as u32;
        let terrain_side = manifest.terrain_side as u32;
        let tile_texels = manifest.tile_texels as u32;
        let terrain_layers = count(Layer::Terrain);
        let mut ground = GroundUpload::new(gpu, mesh, terrain_side, terrain_layers)?;
        let mut maps = MapUpload::new(gpu, tile_texels, count(Layer::Buildings))?;
        let imagery_layers = count(Layer::Imagery);
        let mut imagery = ImageryTiles::new(gpu, manifest.imagery_side as u32, imagery_layers)?;
        let mut tiles = TileSet::new(manifest.grid);
        let mut table = vec![[NONE, NONE, NONE, 0]; ids.len()];
        for (batch, entries) in ids.chunks(BATCH).zip(table.chunks_mut(BATCH)) {
            let loaded: Vec<Tile> = batch
                .par_iter()
                .map(|&id| city.tile(id))
                .collect::<Result<_, CityError>>()?;
            for (tile, entry) in loaded.into_iter().zip(entries) {
                let slot = tile.buildings.as_ref().map(|map| maps.put(gpu, map));
                let layer = tile.imagery.map(|image| imagery.put(gpu, image));
                let terrain = tile.terrain.as_ref().zip(tile.ground_bounds.as_ref());
                let terrain = terrain.and_then(|(terrain, bounds)| ground.put(gpu, tile.id, terrain, bounds));
                let indices = [slot, layer, terrain].map(|index| index.map_or(NONE, |index| index as i32));
                *entry = [indices[0], indices[1], indices[2], 0];
                let ground = tile.terrain.zip(tile.ground_bounds);
                let ground = ground.map(|(terrain, bounds)| GroundTile {
                    heights: terrain.ground,
                    bounds,
                });
                let buildings = tile.buildings;
                tiles.put(tile.id, WalkTile { ground, buildings });
            }
            // So that the device frees the staging memory of the uploads.
            gpu.queue.submit([]);
            gpu.wait()?;
        }
        let grid = &manifest.grid;
        let max = u64::from(gpu.device.limits().max_texture_dimension_2d);
        gpu.require("the tile grid", u64::from(grid.columns.max(grid.rows)), max)?;
        Ok(Self {
            stamps,
            tile_table: table_view(gpu, grid, &table),
            table,
            tiles,
            texel_m: manifest.texel_m,
            tile_texels,
            terrain_step_m: manifest.terrain_step_m,
            terrain_side,
            ground: ground.finish(gpu)?,
            maps: maps.finish(gpu)?,
            imagery,
        })
    }

    /// Takes over the building maps of the city after an update: those whose files changed are read, ground and imagery stay.
    /// How many changed.
    ///
    /// # Errors
    /// When a tile is damaged, or the device cannot hold them.
    pub fn take_buildings(&mut self, gpu: &Gpu, city: &City) -> Result<usize, SceneError> {
        let grid = city.manifest().grid;
        let ids: Vec<TileId> = grid.tiles().collect();
        let stamps: Vec<_> = ids.iter().map(|&id| city.stamp(Layer::Buildings, id)).collect();
        let mut maps = Vec::new();
        for (&id, _) in (ids.iter())
            .zip(stamps.iter().zip(&self.stamps))
            .filter(|(_, (now, before))| now != before)
        {
            let ground = self.tiles.tile(id).and_then(|tile| tile.ground.as_ref());
            maps.push((id, city.map_tile(id, ground.map(|ground| &ground.heights))?));
        }
        let changed = maps.len();
        self.tiles.replace_buildings(maps);
        self.stamps = stamps;
        let buildings = |id: TileId| self.tiles.tile(id)?.buildings.as_ref();
        let count = ids.iter().filter(|&&id| buildings(id).is_some()).count();
        let mut maps = MapUpload::new(gpu, self.tile_texels, count as u32)?;
        for (&id, entry) in ids.iter().zip(&mut self.table) {
            let map = self.tiles.tile(id).and_then(|tile| tile.buildings.as_ref());
            entry[0] = map.map_or(NONE, |map| maps.put(gpu, map) as i32);
        }
        self.maps = maps.finish(gpu)?;
        self.tile_table = table_view(gpu, &grid, &self.table);
        gpu.queue.submit([]);
        gpu.wait()?;
        Ok(changed)
    }

    /// Bytes resident on the GPU.
    pub fn bytes(&self) -> u64 {
        self.ground.bytes + self.maps.bytes + self.imagery.bytes
    }

    /// Ground at a point of the city, metres.
    pub fn ground_at(&self, point: DVec2) -> Option<f64> {
        self.tiles.ground_at(point)
    }
}

fn table_view(gpu: &Gpu, grid: &TileGrid, table: &[[i32; 4]]) -> wgpu::TextureView {
    let format = wgpu::TextureFormat::Rgba32Sint;
    filled_texture(gpu, "tile table", [grid.columns, grid.rows], format, table)
}
