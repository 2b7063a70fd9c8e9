//! The tiles, whole: ground as made before, the building map and the orthophoto.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::TILE_TEXELS;
use super::ground_plan::{GroundPlan, PLAN_PIXEL_M};
use super::plan::Plan;
use super::sources::Sources;
use crate::buildings::{Building, MapTile};
use crate::city::layer::Layer;
use crate::city::raised_footprints::{building_map, buildings_by_tile};
use crate::city::writer::TileWriter;
use crate::city::{CityError, ImageryTile, Tile};
use crate::source::ImageryMosaic;
use crate::space::{Crs, TileGrid, TileId};
use indicatif::ProgressBar;

/// Most orthophoto pixels along a tile's side.
const MAX_IMAGERY_PIXELS: usize = 1024;

/// Counts over all tiles.
#[derive(Clone, Copy, Debug, Default)]
pub struct TileTotals {
    /// Tiles with buildings.
    pub buildings: u64,
    /// Bytes of their maps when loaded.
    pub building_map_bytes: u64,
    /// Tiles with an orthophoto.
    pub imagery: u64,
    /// Orthophoto pixels along a tile's side, 0 without orthophotos.
    pub imagery_side: usize,
}

/// Makes every tile that has buildings or imagery; the others have ground only and are whole already.
pub fn make_tiles(
    (sources, ground_plan): (&Sources, Option<&GroundPlan>),
    plan: &Plan,
    buildings: &[Building],
    writer: &TileWriter<'_>,
    bar: &ProgressBar,
) -> Result<TileTotals, CityError> {
    let by_tile = buildings_by_tile(&plan.grid, buildings);
    let imagery = sources
        .imagery
        .as_ref()
        .map(|mosaic| TileImagery::new(mosaic, &sources.crs, plan.grid));
    let has_imagery = |id: TileId| {
        imagery.as_ref().is_some_and(|imagery| imagery.meets(id))
            || ground_plan.is_some_and(|drawn| drawn.meets(id))
    };
    let imagery_side = match (&imagery, ground_plan) {
        (Some(imagery), _) => imagery.side,
        (None, Some(_)) => side_for(&plan.grid, PLAN_PIXEL_M),
        (None, None) => 0,
    };
    let tiles: Vec<TileId> = plan
        .grid
        .tiles()
        .filter(|&id| by_tile.contains_key(&id) || has_imagery(id))
        .collect();
    bar.set_length(tiles.len() as u64);
    let totals = [const { AtomicU64::new(0) }; 3];
    let footprints = sources.buildings.path();
    tiles
        .par_iter()
        .map(|&id| -> Result<(), CityError> {
            let map = by_tile.get(&id).map(|buildings| {
                building_map(&plan.grid, id, TILE_TEXELS, buildings).map_err(|source| {
                    CityError::TileTooLarge {
                        path: footprints.to_owned(),
                        place: plan.grid.tile_bounds(id).centre(),
                        source,
                    }
                })
            });
            let orthophoto = imagery
                .as_ref()
                .map(|imagery| imagery.tile(id, writer))
                .transpose()?
                .flatten();
            let image = match ground_plan {
                Some(drawn) => drawn.under(id, imagery_side, orthophoto),
                None => orthophoto,
            };
            let tile = Tile::new(id, writer.terrain(id), map.transpose()?.flatten(), image);
            if let Some(buildings) = &tile.buildings {
                let bytes = MapTile::bytes_of(&buildings.map);
                totals[0].fetch_add(1, Ordering::Relaxed);
                totals[1].fetch_add(bytes, Ordering::Relaxed);
            }
            totals[2].fetch_add(u64::from(tile.imagery.is_some()), Ordering::Relaxed);
            writer.put(&tile, &[Layer::Buildings, Layer::Imagery])?;
            bar.inc(1);
            Ok(())
        })
        .collect::<Result<(), _>>()?;
    bar.finish_and_clear();
    let [buildings, building_map_bytes, imagery_tiles] = totals.map(AtomicU64::into_inner);
    Ok(TileTotals {
        buildings,
        building_map_bytes,
        imagery: imagery_tiles,
        imagery_side,
    })
}

/// Pixels along a tile's side for pixels of a size, metres.
fn side_for(grid: &TileGrid, pixel_m: f64) -> usize {
    let mut side = 64;
    while side < MAX_IMAGERY_PIXELS && grid.tile_m / side as f64 > 1.01 * pixel_m {
        side *= 2;
    }
    side
}

/// The imagery mosaic, cut into tiles.
struct TileImagery<'a> {
    mosaic: &'a ImageryMosaic,
    crs: &'a Crs,
    grid: TileGrid,
    /// Pixels along a tile's side.
    side: usize,
}

impl<'a> TileImagery<'a> {
    /// With as many pixels along a tile's side as the finest source needs.
    fn new(mosaic: &'a ImageryMosaic, crs: &'a Crs, grid: TileGrid) -> Self {
        Self {
            mosaic,
            crs,
            grid,
            side: side_for(&grid, mosaic.finest_pixel_m()),
        }
    }

    fn meets(&self, id: TileId) -> bool {
        self.mosaic.meets(&self.grid.tile_bounds(id))
    }

    /// A tile's image, none where no source has a pixel.
    fn tile(&self, id: TileId, writer: &TileWriter<'_>) -> Result<Option<ImageryTile>, CityError> {
        let known = writer.imagery(id, self.side);
        if known.is_some() || !self.meets(id) {
            return Ok(known);
        }
        let rgba = self
            .mosaic
            .warp(self.crs, &self.grid.tile_bounds(id), self.side)?;
        let is_empty = rgba.chunks_exact(4).all(|pixel| pixel[3] == 0);
        let side = self.side;
        Ok((!is_empty).then_some(ImageryTile { side, rgba }))
    }
}
