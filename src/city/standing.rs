//! Footprints stood on a city's ground: the one way from a footprint dataset to buildings, for an import and for a city
//! that is read back.

use std::sync::{Mutex, PoisonError};

use glam::DVec2;
use rayon::prelude::*;

use super::ground::Ground;
use super::{City, CityError};
use crate::buildings::Building;
use crate::source::{Footprint, FootprintDataset, HeightOrigin};
use crate::space::Crs;

/// Buildings and what became of their footprints.
pub struct StoodFootprints {
    /// The buildings, by id.
    pub buildings: Vec<Building>,
    /// What gave each building its height.
    pub height_origins: Vec<HeightOrigin>,
    /// Buildings of which a part lies over missing ground.
    pub partly_missing: u64,
    /// Footprints without ground, which are no buildings.
    pub groundless: u64,
}

/// Gives every footprint its base and roof.
///
/// # Errors
/// When a terrain tile cannot be read.
pub fn stand_on_ground(footprints: Vec<Footprint>, ground: &Ground) -> Result<StoodFootprints, CityError> {
    let failure: Mutex<Option<CityError>> = Mutex::new(None);
    let height = |x: f64, y: f64| {
        ground.at(DVec2::new(x, y)).unwrap_or_else(|error| {
            let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
            failure.get_or_insert(error);
            None
        })
    };
    let count = footprints.len() as u64;
    let mut stood: Vec<(Building, bool, HeightOrigin)> = footprints
        .into_par_iter()
        .filter_map(|footprint| {
            let origin = footprint.height_origin;
            let (building, partly_missing) = Building::on_ground(footprint, height).ok()?;
            Some((building, partly_missing, origin))
        })
        .collect();
    if let Some(error) = failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    stood.sort_by_key(|(building, ..)| building.fid);
    Ok(StoodFootprints {
        groundless: count - stood.len() as u64,
        partly_missing: stood
            .iter()
            .filter(|(_, partly_missing, _)| *partly_missing)
            .count() as u64,
        height_origins: stood.iter().map(|(_, _, origin)| *origin).collect(),
        buildings: stood.into_iter().map(|(building, ..)| building).collect(),
    })
}

impl City {
    /// The footprint dataset's buildings with their bases and roofs, by id; needs GDAL.
    ///
    /// # Errors
    /// When the footprint dataset or a terrain tile cannot be read.
    pub fn standing_buildings(&self) -> Result<Vec<Building>, CityError> {
        let manifest = self.manifest();
        let footprints = FootprintDataset::read(
            &self.footprint_dataset_path(),
            &Crs::from_text(&manifest.crs)?,
            &manifest.height_rule,
            manifest.default_height_m,
        )?;
        Ok(stand_on_ground(footprints, &Ground::new(self))?.buildings)
    }
}
