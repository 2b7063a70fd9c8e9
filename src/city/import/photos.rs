//! Photo tiles.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::plan::Plan;
use super::progress::progress;
use super::sources::Sources;
use crate::city::CityError;
use crate::city::codec::{self, PhotoTile};
use crate::city::geotiff::GeoKeys;
use crate::city::store::{Layer, tile_path};
use crate::space::TileId;

/// Most photo pixels along a tile's side.
const MOST_PHOTO_PIXELS: usize = 1024;

/// Warps the photos tile by tile; returns the pixels along a side (0 without photos) and the
/// number of tiles.
pub fn make_photos(
    sources: &Sources,
    plan: &Plan,
    folder: &Path,
    keys: &GeoKeys,
) -> Result<(usize, u64), CityError> {
    let Some(photos) = &sources.photos else {
        return Ok((0, 0));
    };
    let mut side = 64;
    while side < MOST_PHOTO_PIXELS && plan.grid.tile_m / side as f64 > 1.01 * photos.finest_pixel_m() {
        side *= 2;
    }
    let crs = &sources.crs;
    let tiles: Vec<TileId> = plan
        .grid
        .tiles()
        .filter(|&id| photos.meet(&plan.grid.tile_bounds(id)))
        .collect();
    let bar = progress("photos", tiles.len() as u64);
    let written = AtomicU64::new(0);
    tiles
        .par_iter()
        .map(|&id| -> Result<(), CityError> {
            bar.inc(1);
            let path = tile_path(folder, Layer::Photo, id);
            if codec::read_photo(&path, side).is_err() {
                let bounds = plan.grid.tile_bounds(id);
                let rgba = photos.warp(crs, &bounds, side)?;
                if rgba.chunks_exact(4).all(|pixel| pixel[3] == 0) {
                    return Ok(());
                }
                codec::write_photo(&path, &bounds, &PhotoTile { side, rgba }, keys)?;
            }
            written.fetch_add(1, Ordering::Relaxed);
            Ok(())
        })
        .collect::<Result<(), _>>()?;
    bar.finish_and_clear();
    Ok((side, written.into_inner()))
}
