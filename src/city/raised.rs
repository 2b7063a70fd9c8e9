//! The footprint dataset's buildings with their bases and roofs. The one reader of a finished city that needs GDAL.

use rayon::prelude::*;

use super::{City, CityError};
use crate::buildings::Building;
use crate::source::FootprintDataset;
use crate::space::Crs;

impl City {
    /// Every footprint on its base; those without ground are left out. `ground`: metres at a point of the city.
    ///
    /// # Errors
    /// When the dataset cannot be read.
    pub fn raised_buildings(
        &self,
        ground: impl Fn(f64, f64) -> Option<f64> + Sync,
    ) -> Result<Vec<Building>, CityError> {
        let manifest = self.manifest();
        let crs = Crs::from_text(&manifest.crs)?;
        let footprints = FootprintDataset::read(
            &self.footprint_dataset_path(),
            &crs,
            &manifest.height_rule,
            manifest.default_height_m,
        )?;
        Ok(footprints
            .into_par_iter()
            .filter_map(|footprint| Building::on_ground(footprint, &ground).ok())
            .map(|(building, _)| building)
            .collect())
    }
}
