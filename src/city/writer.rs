//! Writes tiles into a city folder in the making, and reads back what an interrupted import left there.

use std::path::{Path, PathBuf};

use super::codec::{self, Lattice, TerrainTile, TexelGrid};
use super::geotiff::GeoKeys;
use super::layer::Layer;
use super::{CityError, ImageryTile, Tile};
use crate::space::{TileGrid, TileId};

/// A folder, and what all its tiles have in common.
pub struct TileWriter<'a> {
    /// The folder.
    pub folder: &'a Path,
    /// The tile grid.
    pub grid: TileGrid,
    /// Terrain samples along a tile's side.
    pub terrain_side: usize,
    /// Distance between them on level 0, metres.
    pub terrain_step_m: f64,
    /// The CRS.
    pub keys: &'a GeoKeys,
}

impl TileWriter<'_> {
    /// Where a layer of a tile lies.
    pub fn path(&self, layer: Layer, id: TileId) -> PathBuf {
        layer.tile_path(self.folder, id)
    }

    /// West and north border of a tile, metres.
    pub fn corner(&self, id: TileId) -> [f64; 2] {
        let bounds = self.grid.tile_bounds(id);
        [bounds.west, bounds.north]
    }

    /// Terrain that is there already; none where it is not or cannot be read, and is to be made again.
    pub fn terrain(&self, id: TileId) -> Option<TerrainTile> {
        let lattice = Lattice {
            side: self.terrain_side,
            step_m: self.terrain_step_m,
            level: id.level,
            corner: self.corner(id),
        };
        codec::read_terrain(&self.path(Layer::Terrain, id), lattice).ok()
    }

    /// An orthophoto of `side` pixels that is there already, as for [`Self::terrain`].
    pub fn imagery(&self, id: TileId, side: usize) -> Option<ImageryTile> {
        codec::read_imagery(&self.path(Layer::Imagery, id), side, &self.grid.tile_bounds(id)).ok()
    }

    /// Writes some layers of a tile. What is there already stays as it is: ground and orthophoto, which follow from the sources
    /// alone, and a building map that is the same.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn put(&self, tile: &Tile, layers: &[Layer]) -> Result<(), CityError> {
        let bounds = self.grid.tile_bounds(tile.id);
        let path = |layer| self.path(layer, tile.id);
        if let Some(terrain) = &tile.terrain
            && layers.contains(&Layer::Terrain)
            && self.terrain(tile.id).is_none()
        {
            codec::write_terrain(&path(Layer::Terrain), &bounds, terrain, self.keys)?;
        }
        if let Some(buildings) = &tile.buildings
            && layers.contains(&Layer::Buildings)
        {
            let map = &buildings.map;
            let path = path(Layer::Buildings);
            let level = tile.id.level;
            let texels = TexelGrid {
                side: map.side,
                texel_m: f64::from(map.texel_m) / f64::from(1_u32 << level),
                level,
                corner: self.corner(tile.id),
            };
            let known = codec::read_buildings(&path, texels);
            if known.ok().as_ref() != Some(map) {
                codec::write_buildings(&path, (level, &bounds), map, self.keys)?;
            }
        }
        if let Some(imagery) = &tile.imagery
            && layers.contains(&Layer::Imagery)
            && self.imagery(tile.id, imagery.side).is_none()
        {
            codec::write_imagery(&path(Layer::Imagery), &bounds, imagery, self.keys)?;
        }
        Ok(())
    }
}
