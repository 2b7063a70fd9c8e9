//! A city made ready to be drawn, for as long as it is open: device, resident tiles, pipelines, targets and caches. A frame of
//! a size already drawn makes no resource of the device.

use glam::{DVec2, DVec3};

use super::RenderError;
use super::debug_view::DebugView;
use super::flare_pass::FlarePass;
use super::frame::PASSES;
use crate::buildings::Building;
use crate::camera::{AccumulatePass, ToneMapPass};
use crate::city::City;
use crate::gpu::{Gpu, PassTimer, PassTimes, Target};
use crate::relief::{ReliefPass, ReliefTargets, building_mesh};
use crate::scene::{Resident, TerrainMesh};

/// Everything that lives as long as a city is drawn.
pub struct Renderer {
    /// The device.
    pub gpu: Gpu,
    /// The city's tiles.
    pub resident: Resident,
    pub(super) relief: ReliefPass,
    pub(super) accumulate: AccumulatePass,
    pub(super) flare: FlarePass,
    pub(super) tone_map: ToneMapPass,
    pub(super) debug_view: DebugView,
    pub(super) timer: PassTimer,
    size: [u32; 2],
}

impl Renderer {
    /// Loads a city onto a device: as it is on disk when its last tile is read, should an update come in between.
    ///
    /// # Errors
    /// When a tile is damaged, or the device cannot hold the city.
    pub fn open(gpu: Gpu, city: &City, mesh: TerrainMesh) -> Result<Self, RenderError> {
        let loaded = Resident::load(&gpu, city, mesh);
        let resident = match (loaded, city.updated()?) {
            (loaded, None) => loaded?,
            (Ok(mut resident), Some(newer)) => {
                resident.take_buildings(&gpu, &newer)?;
                resident
            }
            (Err(_), Some(newer)) => Resident::load(&gpu, &newer, mesh)?,
        };
        let renderer = Self {
            relief: ReliefPass::new(&gpu, &resident),
            accumulate: AccumulatePass::new(&gpu),
            flare: FlarePass::new(&gpu),
            tone_map: ToneMapPass::new(&gpu),
            debug_view: DebugView::new(&gpu),
            timer: PassTimer::new(&gpu, &PASSES),
            size: [0; 2],
            gpu,
            resident,
        };
        // So that a shader or pipeline that the device refuses is told here.
        renderer.gpu.wait()?;
        Ok(renderer)
    }

    /// Follows an update of the city: the next frame shows its buildings. Ground and imagery are not touched. How many tiles
    /// changed.
    ///
    /// # Errors
    /// When a tile is damaged, or the device cannot hold the city.
    pub fn follow(&mut self, city: &City) -> Result<usize, RenderError> {
        let changed = self.resident.take_buildings(&self.gpu, city)?;
        self.relief.bind_city(&self.gpu, &self.resident);
        Ok(changed)
    }

    /// Loads the mesh for `ReliefMode::Polygons` beside the building map; gives the buildings that it shows.
    ///
    /// # Errors
    /// When the footprint dataset cannot be read, or the device cannot hold the mesh.
    pub fn load_polygons(&mut self, city: &City) -> Result<Vec<Building>, RenderError> {
        let tiles = &self.resident.tiles;
        let buildings = city.raised_buildings(|x, y| tiles.ground_at(DVec2::new(x, y)))?;
        let centre = city.manifest().grid.bounds().centre();
        let origin = DVec3::new(centre.x, centre.y, 0.0);
        self.relief
            .set_polygons(&self.gpu, &building_mesh(&buildings, origin), origin)?;
        Ok(buildings)
    }

    /// Puts all targets of a size in use.
    pub(super) fn resize(&mut self, size: [u32; 2]) {
        if self.size == size {
            return;
        }
        self.size = size;
        let targets = self.relief.resize(&self.gpu, &self.resident, size);
        self.accumulate.resize(&self.gpu, size, &targets.radiance);
        self.flare.resize(&self.gpu, size);
        if let (Some(sums), Some(flare)) = (self.accumulate.targets(), self.flare.target()) {
            self.tone_map.resize(&self.gpu, size, sums, flare);
        }
    }

    /// Pixels of the last frame.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The images of the relief pass; none before the first frame.
    pub fn relief_targets(&self) -> Option<&ReliefTargets> {
        self.relief.targets()
    }

    /// The displayable image; none before the first frame.
    pub fn image(&self) -> Option<&Target> {
        self.tone_map.image()
    }

    /// The image's sRGB codes as a user interface takes them; none before the first frame.
    pub fn display_view(&self) -> Option<&wgpu::TextureView> {
        self.tone_map.display_view()
    }

    /// GPU milliseconds of the last frame's passes, where the device can time. Waits for the device.
    ///
    /// # Errors
    /// When the device fails.
    pub fn pass_times(&self) -> Result<Option<PassTimes>, RenderError> {
        Ok(self.timer.read(&self.gpu)?)
    }
}
