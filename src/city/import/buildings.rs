//! The footprint dataset of record, and the building-map tiles.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::TILE_TEXELS;
use super::plan::Plan;
use super::progress::progress;
use super::sources::Sources;
use crate::buildings::{Building, Pyramid, rasterise};
use crate::city::CityError;
use crate::city::codec;
use crate::city::geotiff::GeoKeys;
use crate::city::ground::Ground;
use crate::city::standing::stand_on_ground;
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
    let stood = stand_on_ground(footprints, ground)?;
    for _ in 0..stood.groundless {
        report.reject_accepted("no ground under it");
    }
    for _ in 0..stood.partly_missing {
        report.repair("partly over missing ground: stands on what there is");
    }
    for origin in stood.height_origins {
        report.height(origin);
    }
    let buildings = stood.buildings;
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
            let map =
                rasterise(&bounds, TILE_TEXELS, buildings).map_err(|source| CityError::TileTooLarge {
                    path: path.clone(),
                    source,
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
