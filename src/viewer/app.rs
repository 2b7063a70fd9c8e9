//! The window's events, and what each does.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec2;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::KeyCode;
use winit::window::{Window, WindowId};

use super::input::MAX_FLIGHT_S;
use super::journal::{FrameRecord, Journal};
use super::panel::{PanelInfo, panel};
use super::scene_state::{SceneState, first_pose, lenses};
use super::screen::Screen;
use super::{Clock, Navigator, Pace, ViewerError};
use crate::camera::Optics;
use crate::camera::lens::Lens;
use crate::city::City;
use crate::gpu::{Gpu, read_texture};
use crate::output::{FlareSettings, FrameRequest, RenderError, Renderer, write_png};
use crate::relief::ReliefSettings;
use crate::scene::PoolOptions;
use crate::space::{Pose, Projection};

/// What the window begins with.
pub struct ViewerOptions {
    /// The city.
    pub city: City,
    /// How much of it is held on the device.
    pub pool: PoolOptions,
    /// The first view; without one, a view of the whole city.
    pub pose: Option<Pose>,
    /// What makes the image.
    pub optics: Optics,
    /// What the lens adds.
    pub flare: Option<FlareSettings>,
    /// Date and time.
    pub clock: Clock,
    /// Pixels of the window.
    pub size: [u32; 2],
    /// Where images are saved.
    pub image_folder: PathBuf,
    /// A journal of the frames.
    pub journal: Option<PathBuf>,
}

/// Opens the window; returns when it is closed.
///
/// # Errors
/// When there is no display, or the device cannot draw the city.
pub fn run(options: ViewerOptions) -> Result<(), ViewerError> {
    let journal = options.journal.as_deref().map(Journal::create).transpose()?;
    let no_window = |why: String| ViewerError::NoWindow { why };
    let events = EventLoop::new().map_err(|error| no_window(error.to_string()))?;
    let mut app = App {
        started: Instant::now(),
        options,
        journal,
        running: None,
        failure: None,
    };
    events
        .run_app(&mut app)
        .map_err(|error| no_window(error.to_string()))?;
    app.failure.map_or(Ok(()), Err)
}

/// How often the city folder is checked for updates.
const CHECK_INTERVAL: Duration = Duration::from_millis(300);

struct App {
    started: Instant,
    options: ViewerOptions,
    journal: Option<Journal>,
    running: Option<Running>,
    failure: Option<ViewerError>,
}

/// An open window on a loaded city.
pub(super) struct Running {
    pub(super) screen: Screen,
    pub(super) renderer: Renderer,
    pub(super) state: SceneState,
    pub(super) lenses: Vec<Arc<Lens>>,
    pub(super) pace: Pace,
    pub(super) keys: Vec<KeyCode>,
    pub(super) cursor: DVec2,
    /// The image shown, and its pixels.
    pub(super) shown: Option<wgpu::TextureView>,
    pub(super) shown_size: [u32; 2],
    pub(super) frame_ms: f64,
    pub(super) last_frame: Instant,
    pub(super) last_check: Instant,
    pub(super) generation: u64,
    pub(super) message: String,
    pub(super) shows_panel: bool,
    pub(super) saves_image: bool,
}

impl App {
    fn open(&mut self, events: &ActiveEventLoop) -> Result<Running, ViewerError> {
        let no_window = |why: String| ViewerError::NoWindow { why };
        let [width, height] = self.options.size;
        let attributes = Window::default_attributes()
            .with_title(format!("{} - Rilievo", self.options.city.manifest().name))
            .with_inner_size(PhysicalSize::new(width, height));
        let window = events
            .create_window(attributes)
            .map_err(|error| no_window(error.to_string()))?;
        let window = Arc::new(window);
        let (gpu, surface, configuration) =
            Gpu::open_for_window(Arc::clone(&window)).map_err(RenderError::from)?;
        let screen = Screen::new(&gpu, window, surface, configuration);
        let renderer = Renderer::open(gpu, &self.options.city, self.options.pool)?;
        let tiles = &renderer.resident.tiles;
        let pose = self.options.pose.unwrap_or_else(|| first_pose(tiles));
        let state = SceneState {
            navigator: Navigator::new(tiles, pose),
            optics: self.options.optics.clone(),
            flare: self.options.flare.clone(),
            sun: self.options.clock.sun()?,
            clock: self.options.clock.clone(),
            exposure_stops: 0.0,
        };
        screen.window.request_redraw();
        Ok(Running {
            screen,
            renderer,
            state,
            lenses: lenses(),
            pace: Pace::new(Instant::now()),
            keys: Vec::new(),
            cursor: DVec2::ZERO,
            shown: None,
            shown_size: [0; 2],
            frame_ms: 0.0,
            last_frame: Instant::now(),
            last_check: Instant::now(),
            generation: self.options.city.manifest().generation,
            message: String::new(),
            shows_panel: true,
            saves_image: false,
        })
    }

    fn fail(&mut self, events: &ActiveEventLoop, error: ViewerError) {
        self.failure = Some(error);
        events.exit();
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.running.is_some() {
            return;
        }
        match self.open(events) {
            Ok(running) => self.running = Some(running),
            Err(error) => self.fail(events, error),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(running) = &mut self.running else { return };
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => {
                let name = &self.options.city.manifest().name;
                let drawn = running.draw(name, &self.options.image_folder);
                let written = drawn.and_then(|is_new| match &mut self.journal {
                    Some(journal) if is_new => journal.write(&running.record(self.started)),
                    _ => Ok(()),
                });
                if let Err(error) = written {
                    self.fail(events, error);
                }
            }
            event => {
                if running.on_event(&event) {
                    events.exit();
                }
            }
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(running) = &mut self.running else { return };
        if running.last_check.elapsed() >= CHECK_INTERVAL {
            running.last_check = Instant::now();
            // What cannot be read just now is looked at again.
            match self.options.city.updated() {
                Ok(None) => {}
                Ok(Some(newer)) => match running.follow(&newer) {
                    Ok(()) => self.options.city = newer,
                    Err(error) => running.message = error.to_string(),
                },
                Err(error) => running.message = error.to_string(),
            }
        }
        if running.wants_frame() {
            running.screen.window.request_redraw();
        }
        events.set_control_flow(ControlFlow::WaitUntil(running.last_check + CHECK_INTERVAL));
    }
}

impl Running {
    pub(super) fn projection(&self) -> Projection {
        self.state.projection(self.screen.size())
    }

    fn wants_frame(&mut self) -> bool {
        !self.keys.is_empty()
            || self.saves_image
            || self.screen.overlay.is_animated()
            || self.renderer.resident.is_loading()
            || self.pace.next(Instant::now()).is_some()
    }

    pub(super) fn moved(&mut self) {
        self.pace.moved(Instant::now());
        self.screen.window.request_redraw();
    }

    /// Shows the city as an update left it.
    fn follow(&mut self, city: &City) -> Result<(), ViewerError> {
        let tiles = self.renderer.follow(city)?;
        self.generation = city.manifest().generation;
        self.message = format!("updated: {tiles} tiles, generation {}", self.generation);
        self.moved();
        Ok(())
    }

    /// Draws the next frame, if one is wanted, and the screen. True when a frame was drawn.
    fn draw(&mut self, city: &str, image_folder: &std::path::Path) -> Result<bool, ViewerError> {
        let now = Instant::now();
        let seconds = now
            .duration_since(self.last_frame)
            .as_secs_f64()
            .min(MAX_FLIGHT_S);
        self.last_frame = now;
        self.fly(seconds);
        let camera = self.state.camera();
        let request = |size: [u32; 2]| FrameRequest {
            camera: &camera,
            sun: &self.state.sun,
            size,
            relief: ReliefSettings::default(),
            flare: self.state.flare.as_ref(),
            exposure: self.state.exposure_stops.exp2(),
        };
        let full_size = self.screen.size();
        self.renderer.detail_size = Some(full_size);
        let version = self.renderer.resident.version();
        self.renderer.prepare(&request(full_size))?;
        if self.renderer.resident.version() != version {
            // Tiles came: as in motion, until all are there.
            self.pace.moved(now);
        }
        if let Some(warning) = self.renderer.resident.take_warnings().pop() {
            self.message = warning;
        }
        let step = self.pace.next(now);
        if let Some(step) = step {
            let size = full_size.map(|side| ((f64::from(side) * step.scale).round() as u32).max(1));
            let request = request(size);
            self.renderer.frame_band(&request, step.sample, step.band)?;
            self.renderer.gpu.wait().map_err(RenderError::from)?;
            let Some(took) = self.pace.drawn(step, now.elapsed()) else {
                // The image is the one before; only the panel may be another one.
                if self.screen.overlay.is_used() {
                    self.draw_screen(city)?;
                }
                return Ok(false);
            };
            self.frame_ms = took.as_secs_f64() * 1e3;
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
            self.message = self.save_image(city, image_folder)?;
        }
        self.draw_screen(city)?;
        Ok(step.is_some())
    }

    fn draw_screen(&mut self, city: &str) -> Result<(), ViewerError> {
        let begun = Instant::now();
        let is_due = self
            .screen
            .overlay
            .is_due(self.screen.size(), self.pace.is_moving());
        if is_due {
            self.paint_panel(city)?;
        }
        if let Some(view) = &self.shown {
            self.screen.draw(&self.renderer.gpu, view);
        }
        // The panel is painted now and then only.
        if !is_due {
            self.pace.shown(begun.elapsed());
        }
        Ok(())
    }

    fn paint_panel(&mut self, city: &str) -> Result<(), ViewerError> {
        let info = PanelInfo {
            city,
            device: &self.renderer.gpu.adapter_name,
            frame_ms: self.frame_ms,
            frame: self.shown_size,
            samples: self.pace.samples(),
            message: &self.message,
            lenses: &self.lenses,
        };
        let (shows_panel, state, size) = (self.shows_panel, &mut self.state, self.screen.size());
        let mut changed = false;
        let Screen { window, overlay, .. } = &mut self.screen;
        overlay.paint(&self.renderer.gpu, window, size, |context| {
            if shows_panel {
                egui::Window::new(info.city)
                    .anchor(egui::Align2::LEFT_TOP, [12.0, 12.0])
                    .resizable(false)
                    .show(context, |ui| changed |= panel(ui, state, &info));
            }
        });
        if changed {
            self.state.sun = self.state.clock.sun()?;
            self.moved();
        }
        Ok(())
    }

    /// Writes the image as it is; what to say of it.
    fn save_image(&self, city: &str, folder: &std::path::Path) -> Result<String, ViewerError> {
        let Some(image) = self.renderer.image() else {
            return Ok(String::new());
        };
        let rgba = read_texture(&self.renderer.gpu, &image.texture).map_err(RenderError::from)?;
        let free = (1..10_000)
            .map(|k| folder.join(format!("{city}-{k:03}.png")))
            .find(|path| !path.exists());
        let Some(path) = free else {
            return Ok(format!("{}: is full of images", folder.display()));
        };
        Ok(match write_png(&path, self.renderer.size(), &rgba) {
            Ok(()) => format!("saved {}", path.display()),
            Err(error) => error.to_string(),
        })
    }

    fn record(&self, started: Instant) -> FrameRecord {
        let camera = self.state.camera();
        FrameRecord {
            time_s: started.elapsed().as_secs_f64(),
            eye: camera.pose.eye.to_array(),
            forward: camera.pose.forward.to_array(),
            fov_y: camera.fov_y(self.screen.size()),
            window: self.screen.size(),
            frame: self.shown_size,
            samples: self.pace.samples(),
            frame_ms: self.frame_ms,
            sun_time: self.state.clock.rfc3339(),
            generation: self.generation,
        }
    }
}
