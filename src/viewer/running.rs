//! An open window on a loaded city: its state, and how its frames come about.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::keyboard::{KeyCode, ModifiersState};
use winit::window::Window;

use super::editing::Editing;
use super::glide::{Glide, Momentum};
use super::journal::FrameRecord;
use super::last_view::last_view;
use super::panels::{self, Interface, PanelInfo};
use super::places::Places;
use super::pointer::Pointer;
use super::recorder::Recorder;
use super::scene_state::{SceneState, first_pose, lenses};
use super::screen::Screen;
use super::tools::paint_marks;
use super::{Clock, Navigator, Pace, ViewerError, ViewerOptions};
use crate::camera::lens::Lens;
use crate::city::City;
use crate::gpu::Gpu;
use crate::output::{FrameRequest, PathKey, RenderError, Renderer};
use crate::relief::{ReliefMode, cast_buildings};
use crate::space::Projection;

/// What `City::edited_dataset` gives.
type DatasetStamp = Option<[Option<(SystemTime, u64)>; 2]>;

/// An open window.
pub(super) struct Running {
    pub(super) city: City,
    pub(super) screen: Screen,
    pub(super) renderer: Renderer,
    pub(super) state: SceneState,
    pub(super) interface: Interface,
    pub(super) lenses: Vec<Arc<Lens>>,
    pub(super) places: Option<Places>,
    pub(super) editing: Editing,
    /// The footprint dataset as another program wrote it, when it was looked at last and when it was taken over.
    pub(super) edited: DatasetStamp,
    pub(super) taken_over: DatasetStamp,
    pub(super) pace: Pace,
    /// The streets that the image shows (`Renderer::streets_version`).
    streets: u64,
    pub(super) keys: Vec<KeyCode>,
    pub(super) modifiers: ModifiersState,
    pub(super) pointer: Pointer,
    pub(super) glide: Option<Glide>,
    pub(super) momentum: Momentum,
    /// The image shown, and its pixels.
    shown: Option<wgpu::TextureView>,
    shown_size: [u32; 2],
    pub(super) last_frame: Instant,
    pub(super) last_check: Instant,
    message: String,
    pub(super) saves_image: bool,
    pub(super) image_folder: PathBuf,
    /// Whether the triangles of `ReliefMode::Polygons` are those of the city as it is.
    has_polygons: bool,
}

/// Rays that the statistics count the reads of: columns and rows.
const COUNTED_RAYS: [u32; 2] = [32, 18];

impl Running {
    /// Opens the window.
    pub(super) fn open(
        events: &ActiveEventLoop,
        city: &City,
        options: &ViewerOptions,
    ) -> Result<Self, ViewerError> {
        let no_window = |why: String| ViewerError::NoWindow { why };
        let [width, height] = options.size;
        let manifest = city.manifest();
        let attributes = Window::default_attributes()
            .with_title(format!("{} - Rilievo", manifest.name))
            .with_inner_size(PhysicalSize::new(width, height));
        let window = events
            .create_window(attributes)
            .map_err(|error| no_window(error.to_string()))?;
        let window = Arc::new(window);
        let (gpu, surface, configuration) =
            Gpu::open_for_window(Arc::clone(&window)).map_err(RenderError::from)?;
        let screen = Screen::new(&gpu, window, surface, configuration);
        let renderer = Renderer::open(gpu, city, options.pool)?;
        let tiles = &renderer.resident.tiles;
        let left_with = || last_view(city.folder()).map(|view| view.pose());
        let pose = options
            .pose
            .or_else(left_with)
            .unwrap_or_else(|| first_pose(tiles));
        let navigator = Navigator::new(tiles, pose);
        let state = SceneState::new(
            navigator,
            options.optics.clone(),
            options.flare.clone(),
            options
                .clock
                .clone()
                .unwrap_or_else(|| Clock::midsummer_afternoon(manifest.place)),
        )?;
        let interface = Interface {
            recorder: Recorder::new(options.path.clone().unwrap_or_default()),
            ..Interface::default()
        };
        screen.window.request_redraw();
        Ok(Self {
            // Without a way to the globe there are no degrees.
            places: Places::new(&manifest.crs, manifest.grid.bounds()).ok(),
            editing: Editing::new(city.folder()),
            edited: None,
            taken_over: None,
            city: city.clone(),
            screen,
            renderer,
            state,
            interface,
            lenses: lenses(),
            pace: Pace::new(Instant::now()),
            streets: 0,
            keys: Vec::new(),
            modifiers: ModifiersState::default(),
            pointer: Pointer::default(),
            glide: None,
            momentum: Momentum::default(),
            shown: None,
            shown_size: [0; 2],
            last_frame: Instant::now(),
            last_check: Instant::now(),
            message: String::new(),
            saves_image: false,
            image_folder: options.image_folder.clone(),
            has_polygons: false,
        })
    }

    pub(super) fn projection(&self) -> Projection {
        self.state.projection(self.screen.size())
    }

    /// The view as a key of a flight.
    pub(super) fn key(&self) -> PathKey {
        self.state.key(self.screen.size())
    }

    /// Shows a line about what was done.
    pub(super) fn tell(&mut self, text: String) {
        self.message = text;
        self.screen.window.request_redraw();
    }

    pub(super) fn moved(&mut self) {
        self.pace.moved(Instant::now());
        self.screen.window.request_redraw();
    }

    pub(super) fn wants_frame(&mut self) -> bool {
        self.is_in_motion()
            || self.saves_image
            || self.screen.overlay.is_animated()
            || self.renderer.is_loading()
            || self.renderer.streets_version() != self.streets
            || self.pointer.is_due()
            || self.refines()
    }

    /// Whether the image can become better; not while an edit is made, which is waited for.
    fn refines(&mut self) -> bool {
        let has_more = self.pace.next(Instant::now()).is_some();
        has_more && (self.pace.is_moving() || !self.editing.is_busy())
    }

    /// When to look again, even if nothing happens.
    pub(super) fn wakes_at(&self, interval: Duration) -> Instant {
        let busy = Instant::now() + Duration::from_millis(15);
        let next = self.last_check + interval;
        match self.editing.is_busy() || self.pointer.is_waiting() {
            true => next.min(busy),
            false => next,
        }
    }

    /// Shows the city as an update left it.
    pub(super) fn follow(&mut self, city: &City) -> Result<(), ViewerError> {
        let tiles = self.renderer.follow(city)?;
        self.city = city.clone();
        self.has_polygons = false;
        self.pointer.forget();
        let selected = self
            .interface
            .selection
            .as_ref()
            .map(|selection| selection.details.building.fid);
        if let Some(fid) = selected {
            self.select(Some(fid));
        }
        self.tell(format!(
            "updated: {tiles} tiles, generation {}",
            city.manifest().generation
        ));
        self.moved();
        Ok(())
    }

    /// Draws the next frame, if one is wanted, and the screen. True when a frame was drawn.
    pub(super) fn draw(&mut self) -> Result<bool, ViewerError> {
        let now = Instant::now();
        let seconds = now.duration_since(self.last_frame).as_secs_f64();
        self.last_frame = now;
        self.animate(seconds)?;
        if self.state.relief.mode == ReliefMode::Polygons && !self.has_polygons {
            self.renderer.load_polygons(&self.city)?;
            self.has_polygons = true;
        }
        (self.pace.max_samples, self.pace.frames_per_s) = (self.state.max_samples, self.state.frames_per_s);
        let camera = self.state.camera();
        let request = |size: [u32; 2]| FrameRequest {
            camera: &camera,
            sun: &self.state.sun,
            size,
            relief: self.state.relief,
            flare: self.state.flare.as_ref().filter(|_| self.state.shows_flare),
            exposure: self.state.exposure_stops.exp2(),
        };
        let full_size = self.screen.size();
        self.renderer.detail_size = Some(full_size);
        self.renderer.is_amid_image = self.pace.is_amid_image();
        let version = self.renderer.resident.version();
        self.renderer.prepare(&request(full_size))?;
        let resident = &self.renderer.resident;
        if resident.version() != version || resident.is_making_room() {
            // Tiles came, or are about to: as in motion, until all are there.
            self.pace.moved(now);
        } else if self.renderer.streets_version() != self.streets {
            self.pace.begin_anew();
        }
        self.streets = self.renderer.streets_version();
        if self.pace.is_full() && !self.renderer.is_loading() {
            let Renderer { resident, gpu, .. } = &mut self.renderer;
            resident.make_room_ahead(gpu).map_err(RenderError::from)?;
        }
        if let Some(warning) = self.renderer.resident.take_warnings().pop() {
            self.message = warning;
        }
        let step = self.pace.next(now);
        if let Some(step) = step {
            let size = full_size.map(|side| ((f64::from(side) * step.scale).round() as u32).max(1));
            let request = request(size);
            match step.in_motion {
                true => self.renderer.moving_frame(&request)?,
                false => self.renderer.frame_band(&request, step.sample, step.band)?,
            }
            self.renderer.gpu.wait().map_err(RenderError::from)?;
            let Some(took) = self.pace.drawn(step, now.elapsed()) else {
                // The image is the one before; only the panels may be other ones.
                if self.screen.overlay.is_used() || self.pointer.is_due() {
                    self.draw_screen()?;
                }
                return Ok(false);
            };
            self.interface.statistics.add_frame(took.as_secs_f64() * 1e3);
            self.shown_size = size;
            // Codes as they are, or decoded for a surface that encodes them again.
            let view = if self.screen.is_srgb() {
                self.renderer.image().map(|image| &image.view)
            } else {
                self.renderer.display_view()
            };
            self.shown = view.cloned();
        }
        if self.saves_image && self.pace.is_full() {
            self.saves_image = false;
            self.message = self.save_image()?;
        }
        self.draw_screen()?;
        Ok(step.is_some())
    }

    fn draw_screen(&mut self) -> Result<(), ViewerError> {
        let begun = Instant::now();
        let is_live = self.interface.statistics.is_shown;
        let overlay = &self.screen.overlay;
        let is_due = overlay.is_due(self.screen.size(), self.pace.is_moving(), is_live);
        if is_due {
            self.paint_panels()?;
        }
        if let Some(view) = &self.shown {
            self.screen.draw(&self.renderer.gpu, Some(view));
        }
        // The panels are painted now and then only.
        if !is_due {
            self.pace.shown(begun.elapsed());
        }
        Ok(())
    }

    fn paint_panels(&mut self) -> Result<(), ViewerError> {
        let is_still = !self.pace.is_moving();
        if is_still {
            self.look_under_cursor();
        }
        self.measure_statistics()?;
        // Marks that lag behind the image would be worse than none.
        let marks = match is_still || self.screen.overlay.is_cheap() {
            true => self.marks(),
            false => Vec::new(),
        };
        let (projection, size) = (self.projection(), self.screen.size());
        let info = PanelInfo {
            city: &self.city.manifest().name,
            device: &self.renderer.gpu.adapter_name,
            frame: self.shown_size,
            samples: self.pace.samples(),
            message: &self.message,
            lenses: &self.lenses,
            loaded: self.renderer.resident.loaded_fraction(),
            edits: (self.editing.depth, self.editing.is_busy()),
            under_cursor: self.pointer.label(),
        };
        let (state, interface) = (&mut self.state, &mut self.interface);
        let tiles = &self.renderer.resident.tiles;
        let Screen { window, overlay, .. } = &mut self.screen;
        let mut actions = Vec::new();
        overlay.paint(&self.renderer.gpu, window, size, |context| {
            let painter = context.layer_painter(egui::LayerId::background());
            paint_marks(&painter, tiles, &projection, &marks, context.pixels_per_point());
            interface.statistics.is_shown = false;
            actions = panels::show(context, state, interface, &info);
        });
        for action in actions {
            self.act(action)?;
        }
        Ok(())
    }

    /// What the statistics show, when they are shown.
    fn measure_statistics(&mut self) -> Result<(), ViewerError> {
        let statistics = &mut self.interface.statistics;
        if !statistics.is_shown {
            return Ok(());
        }
        let resident = &self.renderer.resident;
        statistics.resident = [resident.bytes(), resident.map_bytes(), resident.count() as u64];
        statistics.passes = self.renderer.pass_times()?.unwrap_or_default();
        if !self.pace.is_moving() && self.pace.samples() <= 1 {
            let projection = self.state.projection(COUNTED_RAYS);
            let [columns, rows] = COUNTED_RAYS;
            let reads: u32 = (0..columns * rows)
                .map(|k| {
                    let direction = projection.ray_direction(k % columns, k / columns);
                    cast_buildings(&resident.tiles, projection.pose.eye, direction, f32::INFINITY).1
                })
                .sum();
            statistics.reads_per_ray = Some(f64::from(reads) / f64::from(columns * rows));
        }
        Ok(())
    }

    pub(super) fn record(&self, started: Instant) -> FrameRecord {
        let camera = self.state.camera();
        FrameRecord {
            time_s: started.elapsed().as_secs_f64(),
            eye: camera.pose.eye.to_array(),
            forward: camera.pose.forward.to_array(),
            fov_y: camera.fov_y(self.screen.size()),
            window: self.screen.size(),
            frame: self.shown_size,
            samples: self.pace.samples(),
            frame_ms: self.interface.statistics.frame_ms(),
            sun_time: self.state.clock.rfc3339(),
            generation: self.city.manifest().generation,
            selected: self
                .interface
                .selection
                .as_ref()
                .map_or(0, |selection| selection.details.building.fid),
            edits: self.editing.depth[0],
            path_keys: self.interface.recorder.path.keys.len(),
            measured_m: self.interface.measure.lengths()[1],
        }
    }
}
