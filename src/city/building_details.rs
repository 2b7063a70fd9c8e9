//! One building as the footprint dataset of record knows it.

use super::ground_cache::GroundCache;
use super::raised_footprints::raise_on_tiles;
use super::{City, CityError};
use crate::buildings::Building;
use crate::source::{FootprintSource, Selection};
use crate::space::Crs;

/// A building and its attributes.
#[derive(Clone, Debug)]
pub struct BuildingDetails {
    /// Outline, base and roof.
    pub building: Building,
    /// Names and values of its attributes that have one.
    pub attributes: Vec<(String, String)>,
}

impl City {
    /// The footprint dataset of record, opened.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn footprint_dataset(&self) -> Result<FootprintSource, CityError> {
        Ok(FootprintSource::open_footprint_dataset(&self.footprint_dataset_path(), None)?.require_ids()?)
    }

    /// The ground under its buildings.
    pub fn ground(&self) -> GroundCache {
        let manifest = self.manifest();
        GroundCache::new(
            self.folder().to_owned(),
            manifest.grid,
            manifest.terrain_side,
            manifest.terrain_step_m,
        )
    }

    /// A building by its id; none when there is no such, or no ground under it.
    ///
    /// # Errors
    /// When the dataset or the ground cannot be read.
    pub fn building(&self, fid: u32) -> Result<Option<BuildingDetails>, CityError> {
        let dataset = self.footprint_dataset()?;
        let Some(attributes) = dataset.attributes(fid)? else {
            return Ok(None);
        };
        let manifest = self.manifest();
        let to = (
            &Crs::from_text(&manifest.crs)?,
            &manifest.height_rule,
            manifest.default_height_m,
        );
        let mut footprints = Vec::new();
        dataset.read_selected(Selection::Fids(&[fid]), to, |footprint| {
            footprints.push(footprint)
        })?;
        let raised = raise_on_tiles(footprints, &self.facade_rules()?, &self.ground())?;
        let building = raised.buildings.into_iter().next();
        Ok(building.map(|building| BuildingDetails { building, attributes }))
    }
}
