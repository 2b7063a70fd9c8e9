//! A city made ready to be drawn: device, resident tiles, pipelines.

use glam::DVec3;
use rayon::prelude::*;

use super::RenderError;
use crate::buildings::Building;
use crate::city::City;
use crate::gpu::Gpu;
use crate::relief::{ReliefMode, ReliefPass, building_mesh};
use crate::scene::{Resident, TerrainMesh};
use crate::source::{FootprintDataset, silence_gdal};
use crate::space::{Crs, TileId};
use crate::terrain::HeightTile;

/// Everything that lives as long as the city is drawn.
pub struct Renderer {
    /// The device.
    pub gpu: Gpu,
    /// The city's tiles.
    pub resident: Resident,
    /// The pipelines.
    pub relief: ReliefPass,
}

impl Renderer {
    /// Loads a city for one way of drawing.
    pub fn open(city: &City, mode: ReliefMode, mesh: TerrainMesh) -> Result<Self, RenderError> {
        let gpu = Gpu::open()?;
        let resident = Resident::load(&gpu, city, mesh)?;
        let mut relief = ReliefPass::new(&gpu, &resident);
        if mode == ReliefMode::Polygons {
            add_polygons(&gpu, city, &mut relief)?;
        }
        Ok(Self {
            gpu,
            resident,
            relief,
        })
    }

    /// Loads the mesh for `ReliefMode::Polygons` beside the building map; gives the buildings that it shows.
    pub fn load_polygons(&mut self, city: &City) -> Result<Vec<Building>, RenderError> {
        add_polygons(&self.gpu, city, &mut self.relief)
    }
}

/// Raises the footprint dataset's footprints on the city's ground; needs GDAL, unlike every other way of drawing.
fn add_polygons(gpu: &Gpu, city: &City, relief: &mut ReliefPass) -> Result<Vec<Building>, RenderError> {
    let buildings = standing_buildings(city)?;
    let centre = city.manifest().grid.bounds().centre();
    let origin = DVec3::new(centre.x, centre.y, 0.0);
    relief.set_polygons(gpu, &building_mesh(&buildings, origin), origin)?;
    Ok(buildings)
}

/// The footprint dataset's buildings with their bases and roofs.
fn standing_buildings(city: &City) -> Result<Vec<Building>, RenderError> {
    silence_gdal();
    let manifest = city.manifest();
    let crs = Crs::from_text(&manifest.crs).map_err(crate::city::CityError::from)?;
    let footprints = FootprintDataset::read(
        &city.footprint_dataset_path(),
        &crs,
        &manifest.height_rule,
        manifest.default_height_m,
    )
    .map_err(crate::city::CityError::from)?;
    let tiles: Vec<TileId> = manifest.grid.tiles().collect();
    let grounds: Vec<Option<HeightTile>> = tiles
        .par_iter()
        .map(|&tile| Ok(city.terrain(tile)?.map(|terrain| terrain.ground)))
        .collect::<Result<_, crate::city::CityError>>()?;
    let ground = |x: f64, y: f64| {
        let tile = manifest.grid.tile_at(glam::DVec2::new(x, y))?;
        let origin = manifest.grid.origin(tile);
        let index = (tile.y * manifest.grid.columns + tile.x) as usize;
        grounds[index].as_ref()?.ground(x - origin.x, y - origin.y)
    };
    Ok(footprints
        .into_par_iter()
        .filter_map(|footprint| Building::on_ground(footprint, ground).ok())
        .map(|(building, _)| building)
        .collect())
}
