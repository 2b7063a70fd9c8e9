//! An update in the making: a folder of what it writes before it holds.

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::context::UpdateContext;
use super::tile_change::TileChange;
use crate::city::city_files::PARTIAL;
use crate::city::codec::write_buildings;
use crate::city::geotiff::GeoKeys;
use crate::city::{CityError, Layer};

/// Footprints that an update puts into the dataset.
pub const FOOTPRINTS: &str = "footprints.gpkg";

/// The folder. Dropped before it was committed it leaves nothing behind.
pub struct UpdateFolder<'a> {
    place: &'a UpdateContext<'a>,
    path: PathBuf,
    keys: GeoKeys,
}

impl<'a> UpdateFolder<'a> {
    /// Begins an update; what an interrupted one left unfinished is thrown away.
    ///
    /// # Errors
    /// When the folder cannot be made, or no GeoTIFF can tell the city's CRS.
    pub fn begin(place: &'a UpdateContext<'a>) -> Result<Self, CityError> {
        let keys = GeoKeys::from_crs(place.crs)?;
        let path = place.city.folder().join(PARTIAL);
        remove_folder(&path)?;
        let folder = Self { place, path, keys };
        for level in 0..place.city.manifest().grid.levels() {
            let tiles = Layer::Buildings.level_path(&folder.path, level);
            fs::create_dir_all(&tiles).map_err(CityError::file(&tiles))?;
        }
        Ok(folder)
    }

    /// What is updated.
    pub fn context(&self) -> &'a UpdateContext<'a> {
        self.place
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where changed footprints are written.
    pub fn footprints(&self) -> PathBuf {
        self.path.join(FOOTPRINTS)
    }

    /// Writes the new maps of tiles.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn write_tiles(&self, tiles: &[TileChange]) -> Result<(), CityError> {
        let grid = &self.place.city.manifest().grid;
        tiles.par_iter().try_for_each(|tile| {
            let Some(map) = &tile.map else { return Ok(()) };
            let path = Layer::Buildings.tile_path(&self.path, tile.id);
            let bounds = grid.tile_bounds(tile.id);
            write_buildings(&path, (tile.id.level, &bounds), map, &self.keys)
        })
    }
}

impl Drop for UpdateFolder<'_> {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Removes a folder that may be there.
pub fn remove_folder(folder: &Path) -> Result<(), CityError> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(CityError::file(folder)(error)),
        _ => Ok(()),
    }
}
