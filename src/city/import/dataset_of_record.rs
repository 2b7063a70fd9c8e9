//! The footprint dataset of record, from footprints on the ground.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use super::ground_cache::GroundCache;
use super::sources::Sources;
use crate::buildings::Building;
use crate::city::CityError;
use crate::city::raised_footprints::raise_footprints;
use crate::source::{Footprint, FootprintDatasetWriter, FootprintReport};

/// Gives every footprint its base and roof, counts what gave the heights, and writes those that have ground to the
/// footprint dataset, with their attributes.
pub fn make_footprint_dataset(
    sources: &Sources,
    footprints: Vec<Footprint>,
    ground: &GroundCache,
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
