//! The footprint dataset of record, from footprints on the ground.

use std::path::Path;

use super::sources::Sources;
use crate::buildings::Building;
use crate::city::CityError;
use crate::city::ground_cache::GroundCache;
use crate::city::raised_footprints::raise_on_tiles;
use crate::material::FacadeRules;
use crate::source::{Footprint, FootprintDatasetWriter, FootprintReport};

/// Gives every footprint its base, roof and material, counts what gave the heights, and writes those that have ground to the
/// footprint dataset, with their attributes.
pub fn make_footprint_dataset(
    sources: &Sources,
    (footprints, rules): (Vec<Footprint>, &FacadeRules),
    ground: &GroundCache,
    path: &Path,
    report: &mut FootprintReport,
) -> Result<Vec<Building>, CityError> {
    let raised = raise_on_tiles(footprints, rules, ground)?;
    raised.count_in(report);
    let buildings = raised.buildings;
    let mut dataset = FootprintDatasetWriter::create(path, &sources.crs)?;
    let written = sources.buildings.copy_to(&mut dataset, |fid| {
        let index = buildings
            .binary_search_by_key(&fid, |building| building.fid)
            .ok()?;
        Some(&buildings[index].outline)
    })?;
    if written != buildings.len() as u64 {
        // The two readings of the source differ.
        return Err(CityError::SourceChanged {
            path: sources.buildings.path().to_owned(),
        });
    }
    dataset.finish()?;
    Ok(buildings)
}
