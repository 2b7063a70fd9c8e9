//! Footprints on a city's ground, and the building map that they give a tile: the one way from footprints to tiles, for an
//! import, for a city that is read back, and for a tile that is made again.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::ground_cache::GroundCache;
use super::{City, CityError};
use crate::buildings::{Building, BuildingMap, MapTooLarge, rasterise};
use crate::material::FacadeRules;
use crate::source::{Footprint, FootprintDataset, FootprintReport, HeightOrigin};
use crate::space::{Crs, TileGrid, TileId};

/// Buildings and what became of their footprints.
#[derive(Clone, Debug)]
pub struct RaisedFootprints {
    /// The buildings, by id.
    pub buildings: Vec<Building>,
    /// What gave each building its height.
    pub height_origins: Vec<HeightOrigin>,
    /// Buildings of which a part lies over missing ground.
    pub partly_missing: u64,
    /// Footprints without ground, which are no buildings.
    pub groundless: u64,
}

/// Gives every footprint its base, roof and material. `ground`: metres at a point of the city.
pub fn raise_footprints(
    footprints: Vec<Footprint>,
    rules: &FacadeRules,
    ground: impl Fn(f64, f64) -> Option<f64> + Sync,
) -> RaisedFootprints {
    let count = footprints.len();
    let mut raised: Vec<(Building, bool, HeightOrigin)> = footprints
        .into_par_iter()
        .filter_map(|footprint| {
            let origin = footprint.height_origin;
            let (building, partly_missing) = Building::on_ground(footprint, rules, &ground).ok()?;
            Some((building, partly_missing, origin))
        })
        .collect();
    raised.sort_by_key(|(building, ..)| building.fid);
    let partly_missing = raised.iter().filter(|(_, partly_missing, _)| *partly_missing);
    RaisedFootprints {
        groundless: (count - raised.len()) as u64,
        partly_missing: partly_missing.count() as u64,
        height_origins: raised.iter().map(|(_, _, origin)| *origin).collect(),
        buildings: raised.into_iter().map(|(building, ..)| building).collect(),
    }
}

/// The same on the ground of a city folder.
///
/// # Errors
/// When a terrain tile is damaged.
pub fn raise_on_tiles(
    footprints: Vec<Footprint>,
    rules: &FacadeRules,
    ground: &GroundCache,
) -> Result<RaisedFootprints, CityError> {
    let failure: Mutex<Option<CityError>> = Mutex::new(None);
    let raised = raise_footprints(footprints, rules, |x, y| {
        ground.at(x, y).unwrap_or_else(|error| {
            let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
            failure.get_or_insert(error);
            None
        })
    });
    match failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => Ok(raised),
    }
}

impl RaisedFootprints {
    /// Counts what became of the footprints on the ground.
    pub fn count_in(&self, report: &mut FootprintReport) {
        for _ in 0..self.groundless {
            report.reject_accepted("no ground under it");
        }
        for _ in 0..self.partly_missing {
            report.repair("partly over missing ground: stands on what there is");
        }
        for &origin in &self.height_origins {
            report.height(origin);
        }
    }
}

/// The buildings whose rectangles meet each tile. `buildings` must be sorted by id, and so are a tile's.
pub fn buildings_by_tile<'a>(
    grid: &TileGrid,
    buildings: &'a [Building],
) -> BTreeMap<TileId, Vec<&'a Building>> {
    let mut by_tile: BTreeMap<TileId, Vec<&Building>> = BTreeMap::new();
    for building in buildings {
        for tile in grid.tiles_meeting(&building.bounds()) {
            by_tile.entry(tile).or_default().push(building);
        }
    }
    by_tile
}

/// The building map of a tile of `side` texels; none where only the buildings' rectangles meet it.
///
/// # Errors
/// When the outlines have more vertices than a map can index.
pub fn building_map(
    grid: &TileGrid,
    id: TileId,
    side: usize,
    buildings: &[&Building],
) -> Result<Option<BuildingMap>, MapTooLarge> {
    let map = rasterise(&grid.tile_bounds(id), side, buildings)?;
    Ok((!map.is_empty()).then_some(map))
}

impl City {
    /// Every footprint of the dataset on its base, by id; those without ground are left out. The one reader of a finished city that
    /// needs GDAL.
    ///
    /// # Errors
    /// When the dataset or the ground cannot be read.
    pub fn raised_buildings(&self) -> Result<Vec<Building>, CityError> {
        let manifest = self.manifest();
        let footprints = FootprintDataset::read(
            &self.footprint_dataset_path(),
            &Crs::from_text(&manifest.crs)?,
            &manifest.height_rule,
            manifest.default_height_m,
        )?;
        Ok(raise_on_tiles(footprints, &self.facade_rules()?, &self.ground())?.buildings)
    }
}
