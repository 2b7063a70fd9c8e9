//! What every step of an update needs to know.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

use crate::city::ground_cache::GroundCache;
use crate::city::{City, CityError};
use crate::material::FacadeRules;
use crate::space::Crs;

/// The city to change, its CRS and its ground.
pub struct UpdateContext<'a> {
    /// The city.
    pub city: &'a City,
    /// Its CRS.
    pub crs: &'a Crs,
    /// Its ground.
    pub ground: &'a GroundCache,
    /// What its buildings are made of.
    pub rules: &'a FacadeRules,
    /// Time and length of its footprint dataset when the update began.
    pub dataset_stamp: Option<(SystemTime, u64)>,
}

/// Time and length of a file; none without it.
pub fn stamp_of(path: &Path) -> Option<(SystemTime, u64)> {
    let data = fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

impl UpdateContext<'_> {
    /// Fails when somebody else changed the dataset since the update began.
    pub fn require_dataset_unchanged(&self) -> Result<(), CityError> {
        let path = self.city.footprint_dataset_path();
        match stamp_of(&path) == self.dataset_stamp {
            true => Ok(()),
            false => Err(CityError::EditedDataset { path }),
        }
    }
}
