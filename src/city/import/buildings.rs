//! The footprint dataset of record, and the building-map tiles.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::TILE_TEXELS;
use super::plan::Plan;
use super::progress::progress;
use super::sources::Sources;
use crate::buildings::{Building, Pyramid};
use crate::city::CityError;
use crate::city::codec;
use crate::city::geotiff::GeoKeys;
use crate::city::ground::Ground;
use crate::city::raised::{building_map, buildings_by_tile, raise_footprints};
use crate::city::store::{Layer, tile_path};
use crate::source::{Footprint, FootprintDatasetWriter, FootprintReport};
use crate::space::TileId;

/// Gives every footprint its base and roof, counts what gave the heights, and writes those that have ground to the
/// footprint dataset, with their attributes.
pub fn make_footprint_dataset(
    sources: &Sources,
    footprints: Vec<Footprint>,
    ground: &Ground,
    path: &Path,
    report: &mut FootprintReport,
) -> Result<Vec<Building>, CityError> {
    let failure: Mutex<Option<CityError>> = Mutex::new(None);
    let raised = raise_footprints(footprints, |x, y| {
        ground.at(x, y).unwrap_or_else(|error| {
            let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
            failure.get_or_insert(error);
            None
        })
    });
    if let Some(error) = failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    for _ in 0..raised.groundless {
        report.reject_accepted("no ground under it");
    }
    for _ in 0..raised.partly_missing {
        report.repair("partly over missing ground: stands on what there is");
    }
    for origin in raised.height_origins {
        report.height(origin);
    }
    let buildings = raised.buildings;
    let mut dataset = FootprintDatasetWriter::create(path, &sources.crs)?;
    sources.buildings.copy_to(&mut dataset, |fid| {
        let index = buildings
            .binary_search_by_key(&fid, |building| building.fid)
            .ok()?;
        Some(&buildings[index].outline)
    })?;
    dataset.finish()?;
    Ok(buildings)
}

/// Rasterises every tile a building touches; returns the map's bytes when loaded and the
/// number of tiles.
pub fn make_building_maps(
    buildings: &[Building],
    plan: &Plan,
    folder: &Path,
    keys: &GeoKeys,
) -> Result<(u64, u64), CityError> {
    let tiles: Vec<(TileId, Vec<&Building>)> = buildings_by_tile(&plan.grid, buildings).into_iter().collect();
    let bar = progress("buildings", tiles.len() as u64);
    let (bytes, written) = (AtomicU64::new(0), AtomicU64::new(0));
    tiles
        .par_iter()
        .map(|(id, buildings)| -> Result<(), CityError> {
            let path = tile_path(folder, Layer::Buildings, *id);
            let bounds = plan.grid.tile_bounds(*id);
            let map = building_map(&plan.grid, *id, TILE_TEXELS, buildings).map_err(|source| {
                CityError::TileTooLarge {
                    path: path.clone(),
                    source,
                }
            })?;
            bar.inc(1);
            let Some(map) = map else { return Ok(()) };
            written.fetch_add(1, Ordering::Relaxed);
            bytes.fetch_add((map.bytes() + Pyramid::bytes(map.side)) as u64, Ordering::Relaxed);
            let left = codec::read_buildings(&path, TILE_TEXELS, f64::from(map.texel_m));
            if left.ok().as_ref() != Some(&map) {
                codec::write_buildings(&path, &bounds, &map, keys)?;
            }
            Ok(())
        })
        .collect::<Result<(), _>>()?;
    bar.finish_and_clear();
    Ok((bytes.into_inner(), written.into_inner()))
}
