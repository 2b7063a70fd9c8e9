//! A city made ready to be drawn, for as long as it is open: device, resident tiles, pipelines, targets and caches. A frame of
//! a size already drawn makes no resource of the device.

use glam::DVec3;

use super::debug_view::DebugView;
use super::flare_pass::FlarePass;
use super::frame::PASSES;
use super::windows::MAX_WINDOW_PX;
use super::{FrameRequest, RenderError};
use crate::buildings::Building;
use crate::camera::{AccumulatePass, TemporalPass, ToneMapPass, Vignetting};
use crate::city::City;
use crate::gpu::{Gpu, PassTimer, PassTimes, Target};
use crate::relief::{CityBindings, ReliefPass, ReliefTargets, StreetsRequest, building_mesh};
use crate::scene::{PoolOptions, Resident, SceneError};
use crate::space::ImageWindow;

/// Everything that lives as long as a city is drawn.
pub struct Renderer {
    /// The device.
    pub gpu: Gpu,
    /// The city's tiles.
    pub resident: Resident,
    pub(super) relief: ReliefPass,
    pub(super) accumulate: AccumulatePass,
    pub(super) temporal: TemporalPass,
    /// Number of the next frame in motion: the place of its sample in the sequence.
    pub(super) moving_frames: u32,
    pub(super) flare: FlarePass,
    pub(super) tone_map: ToneMapPass,
    /// Of the last frame's lens, and millimetres of the frame's pixels on the sensor.
    pub(super) vignetting: Option<(Vignetting, f64)>,
    pub(super) debug_view: DebugView,
    pub(super) timer: PassTimer,
    /// Pixels of the image, and the part of it that is drawn.
    size: [u32; 2],
    pub(super) window: ImageWindow,
    /// Longest side that a still draws at once, pixels.
    pub max_window_px: u32,
    /// Pixels of the image that tiles are chosen for; those of a frame unless said otherwise.
    pub detail_size: Option<[u32; 2]>,
    /// Whether an image is drawn of which some bands are still to come.
    pub is_amid_image: bool,
    /// What of the resident tiles the relief is bound to.
    bindings: u64,
}

impl Renderer {
    /// Opens a city on a device. Its tiles come when frames want them.
    ///
    /// # Errors
    /// When the coarsest tile is damaged, or the device cannot hold it.
    pub fn open(gpu: Gpu, city: &City, options: impl Into<PoolOptions>) -> Result<Self, RenderError> {
        Self::open_while(gpu, city, options.into(), |_, _| Ok(()))
    }

    /// The same for a first view, whose tiles come while the device compiles.
    ///
    /// # Errors
    /// When the coarsest tile is damaged, or the device cannot hold it or the view's.
    pub fn open_for(
        gpu: Gpu,
        city: &City,
        options: impl Into<PoolOptions>,
        first: &FrameRequest<'_>,
    ) -> Result<Self, RenderError> {
        let projection = first.camera.projection(first.size);
        Self::open_while(gpu, city, options.into(), |gpu, resident| {
            resident.prepare(gpu, &projection, first.sun)
        })
    }

    fn open_while(
        gpu: Gpu,
        city: &City,
        options: PoolOptions,
        load: impl FnOnce(&Gpu, &mut Resident) -> Result<(), SceneError> + Send,
    ) -> Result<Self, RenderError> {
        let mut resident = Resident::open(&gpu, city, options)?;
        let bindings = resident.bindings_version();
        let city_bindings = CityBindings::new(&gpu, &resident);
        let own_facades = city.own_facades()?;
        let (relief, loaded) = rayon::join(
            || ReliefPass::new(&gpu, city_bindings, &own_facades, options.streams),
            || load(&gpu, &mut resident),
        );
        loaded?;
        let renderer = Self {
            relief: relief?,
            accumulate: AccumulatePass::new(&gpu),
            temporal: TemporalPass::new(&gpu),
            moving_frames: 0,
            flare: FlarePass::new(&gpu),
            tone_map: ToneMapPass::new(&gpu),
            vignetting: None,
            debug_view: DebugView::new(&gpu),
            timer: PassTimer::new(&gpu, &PASSES),
            size: [0; 2],
            window: ImageWindow::whole([0; 2]),
            max_window_px: MAX_WINDOW_PX.min(gpu.device.limits().max_texture_dimension_2d),
            detail_size: None,
            is_amid_image: false,
            bindings,
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
        Ok(self.resident.take_buildings(&self.gpu, city)?)
    }

    /// Makes the tiles of a view resident: all of them, or where frames do not wait what has come in.
    ///
    /// # Errors
    /// When the device fails, or the city became another one.
    pub fn prepare(&mut self, request: &FrameRequest<'_>) -> Result<(), RenderError> {
        let size = self.detail_size.unwrap_or(request.size);
        let projection = request.camera.projection(size);
        self.resident.prepare(&self.gpu, &projection, request.sun)?;
        self.relief.set_mode(&self.gpu, request.relief.mode);
        self.relief.set_sun(&self.gpu, request.sun);
        self.relief
            .set_sun_bounds(&self.gpu, &self.resident, request.sun, projection.pose.eye);
        let layers = request.relief.layers;
        let streets = StreetsRequest {
            view: &projection,
            is_shown: layers.streets,
            hides_imagery: !layers.imagery,
            is_amid_image: self.is_amid_image,
        };
        self.relief.set_streets(&self.gpu, &self.resident, streets);
        self.bind_resident();
        Ok(())
    }

    /// Makes all tiles of the finest level resident, whatever the budget: for rays that go anywhere.
    ///
    /// # Errors
    /// When the device cannot hold them.
    pub fn load_finest(&mut self) -> Result<(), RenderError> {
        self.resident.load_finest(&self.gpu)?;
        self.bind_resident();
        Ok(())
    }

    /// A number that changes when other streets are shown.
    pub fn streets_version(&self) -> u64 {
        self.relief.streets_state().0
    }

    /// Whether tiles, or what is made of them, are still to come.
    pub fn is_loading(&self) -> bool {
        self.resident.is_loading() || self.relief.streets_state().1
    }

    fn bind_resident(&mut self) {
        if self.bindings != self.resident.bindings_version() {
            self.bindings = self.resident.bindings_version();
            self.relief.bind_city(&self.gpu, &self.resident);
        }
    }

    /// Loads the mesh for `ReliefMode::Polygons` beside the building map; gives the buildings that it shows.
    ///
    /// # Errors
    /// When the footprint dataset cannot be read, or the device cannot hold the mesh.
    pub fn load_polygons(&mut self, city: &City) -> Result<Vec<Building>, RenderError> {
        let buildings = city.raised_buildings()?;
        let centre = city.manifest().grid.bounds().centre();
        let origin = DVec3::new(centre.x, centre.y, 0.0);
        self.relief
            .set_polygons(&self.gpu, &building_mesh(&buildings, origin), origin)?;
        Ok(buildings)
    }

    /// Puts all targets for a window of an image of `image` pixels in use.
    pub(super) fn show(&mut self, image: [u32; 2], window: ImageWindow) {
        if self.size == image && self.window == window {
            return;
        }
        let showed_part = self.flare.shows_part();
        if self.size != image {
            self.flare.resize(&self.gpu, image);
        }
        self.flare.show(&self.gpu, image, &window);
        let size = window.size;
        let targets = self.relief.resize(&self.gpu, &self.resident, size);
        self.accumulate.resize(&self.gpu, size, &targets.radiance);
        self.temporal
            .resize(&self.gpu, size, &targets.radiance, &targets.distance);
        let is_other = (self.size, self.window.size) != (image, size);
        if is_other && (showed_part || self.flare.shows_part()) {
            self.tone_map.forget();
        }
        if let (Some(sums), Some(flare)) = (self.accumulate.targets(), self.flare.target()) {
            self.tone_map.resize(&self.gpu, size, sums, flare);
        }
        self.size = image;
        self.window = window;
    }

    /// Pixels of the last frame's image, of which a window may be all that was drawn.
    pub(super) fn image_size(&self) -> [u32; 2] {
        self.size
    }

    /// Pixels of what the last frame drew.
    pub fn size(&self) -> [u32; 2] {
        self.window.size
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
