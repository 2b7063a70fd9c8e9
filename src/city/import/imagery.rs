//! Imagery tiles.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::plan::Plan;
use super::progress::progress;
use super::sources::Sources;
use crate::city::CityError;
use crate::city::codec::{self, ImageryTile};
use crate::city::geotiff::GeoKeys;
use crate::city::store::{Layer, tile_path};
use crate::space::TileId;

/// Most orthophoto pixels along a tile's side.
const MAX_IMAGERY_PIXELS: usize = 1024;

/// Warps the orthophotos tile by tile; returns the pixels along a side (0 without orthophotos) and the
/// number of tiles.
pub fn make_imagery(
    sources: &Sources,
    plan: &Plan,
    folder: &Path,
    keys: &GeoKeys,
) -> Result<(usize, u64), CityError> {
    let Some(imagery) = &sources.imagery else {
        return Ok((0, 0));
    };
    let mut side = 64;
    while side < MAX_IMAGERY_PIXELS && plan.grid.tile_m / side as f64 > 1.01 * imagery.finest_pixel_m() {
        side *= 2;
    }
    let crs = &sources.crs;
    let tiles: Vec<TileId> = plan
        .grid
        .tiles()
        .filter(|&id| imagery.meet(&plan.grid.tile_bounds(id)))
        .collect();
    let bar = progress("photos", tiles.len() as u64);
    let written = AtomicU64::new(0);
    tiles
        .par_iter()
        .map(|&id| -> Result<(), CityError> {
            bar.inc(1);
            let path = tile_path(folder, Layer::Imagery, id);
            if codec::read_imagery(&path, side).is_err() {
                let bounds = plan.grid.tile_bounds(id);
                let rgba = imagery.warp(crs, &bounds, side)?;
                if rgba.chunks_exact(4).all(|pixel| pixel[3] == 0) {
                    return Ok(());
                }
                codec::write_imagery(&path, &bounds, &ImageryTile { side, rgba }, keys)?;
            }
            written.fetch_add(1, Ordering::Relaxed);
            Ok(())
        })
        .collect::<Result<(), _>>()?;
    bar.finish_and_clear();
    Ok((side, written.into_inner()))
}
