//! Buildings stood on the ground, and their building-map tiles.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::TILE_TEXELS;
use super::plan::Plan;
use super::progress::progress;
use crate::buildings::{Building, Pyramid, rasterise};
use crate::city::CityError;
use crate::city::codec;
use crate::city::geotiff::GeoKeys;
use crate::city::ground::Ground;
use crate::city::store::{Layer, tile_path};
use crate::source::{Footprint, FootprintDatasetWriter, FootprintReport};
use crate::space::TileId;

/// A building, whether part of it lies over missing ground, and why its height is the default one; or the id of a
/// footprint without ground.
type Standing = Result<(Building, bool, Option<&'static str>), u32>;

/// Gives every footprint its base and roof; those without ground are left out of the report and the map.
pub fn resolve_base_elevations(
    footprints: Vec<Footprint>,
    ground: &Ground,
    report: &mut FootprintReport,
    map: &mut FootprintDatasetWriter,
) -> Result<Vec<Building>, CityError> {
    let failure: Mutex<Option<CityError>> = Mutex::new(None);
    let standing: Vec<Standing> = footprints
        .into_par_iter()
        .map(|footprint| {
            let (fid, default_height) = (footprint.fid, footprint.default_height);
            Building::on_ground(footprint, |x, y| {
                ground.at(x, y).unwrap_or_else(|error| {
                    let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
                    failure.get_or_insert(error);
                    None
                })
            })
            .map(|(building, partly_missing)| (building, partly_missing, default_height))
            .map_err(|_| fid)
        })
        .collect();
    if let Some(error) = failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let mut buildings = Vec::with_capacity(standing.len());
    let mut groundless = Vec::new();
    for result in standing {
        match result {
            Ok((building, partly_missing, default_height)) => {
                if partly_missing {
                    report.repair("partly over missing ground: stands on what there is");
                }
                if let Some(why) = default_height {
                    report.default_height(why);
                }
                buildings.push(building);
            }
            Err(fid) => {
                report.reject_accepted("no ground under it");
                groundless.push(fid);
            }
        }
    }
    map.remove(&groundless)?;
    buildings.sort_by_key(|building| building.fid);
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
    let mut by_tile: BTreeMap<TileId, Vec<&Building>> = BTreeMap::new();
    for building in buildings {
        for tile in plan.grid.tiles_meeting(&building.bounds()) {
            by_tile.entry(tile).or_default().push(building);
        }
    }
    let tiles: Vec<(TileId, Vec<&Building>)> = by_tile.into_iter().collect();
    let bar = progress("buildings", tiles.len() as u64);
    let (bytes, written) = (AtomicU64::new(0), AtomicU64::new(0));
    tiles
        .par_iter()
        .map(|(id, buildings)| -> Result<(), CityError> {
            let path = tile_path(folder, Layer::Buildings, *id);
            let bounds = plan.grid.tile_bounds(*id);
            let map = rasterise(&bounds, TILE_TEXELS, buildings).map_err(|error| CityError::Unfit {
                what: format!("{}: {error}", path.display()),
                advice: "then run the import again".to_owned(),
            })?;
            if map.vertices.is_empty() && map.cells.iter().all(|&word| word == 0) {
                return Ok(()); // only its rectangle touches the tile
            }
            written.fetch_add(1, Ordering::Relaxed);
            bytes.fetch_add((map.bytes() + Pyramid::bytes(map.side)) as u64, Ordering::Relaxed);
            let left = codec::read_buildings(&path, TILE_TEXELS, f64::from(map.texel_m));
            if left.ok().as_ref() != Some(&map) {
                codec::write_buildings(&path, &bounds, &map, keys)?;
            }
            bar.inc(1);
            Ok(())
        })
        .collect::<Result<(), _>>()?;
    bar.finish_and_clear();
    Ok((bytes.into_inner(), written.into_inner()))
}
