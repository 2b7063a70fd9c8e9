//! The window's life: opened, handed its events, closed.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::WindowId;

use super::journal::Journal;
use super::last_view::remember_view;
use super::running::Running;
use super::{Clock, ViewerError};
use crate::camera::Optics;
use crate::city::City;
use crate::output::{FlareSettings, FlightPath};
use crate::scene::PoolOptions;
use crate::space::Pose;

/// What the window begins with.
pub struct ViewerOptions {
    /// The city.
    pub city: City,
    /// How much of it is held on the device.
    pub pool: PoolOptions,
    /// The first view; without one, that which the city was left with, or one of the whole city.
    pub pose: Option<Pose>,
    /// What makes the image.
    pub optics: Optics,
    /// What the lens adds.
    pub flare: Option<FlareSettings>,
    /// Date and time.
    pub clock: Clock,
    /// A flight to play.
    pub path: Option<FlightPath>,
    /// Pixels of the window.
    pub size: [u32; 2],
    /// Where images and flights are saved.
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
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

struct App {
    started: Instant,
    options: ViewerOptions,
    journal: Option<Journal>,
    running: Option<Running>,
    failure: Option<ViewerError>,
}

impl App {
    fn fail(&mut self, events: &ActiveEventLoop, error: ViewerError) {
        self.failure = Some(error);
        events.exit();
    }

    /// Remembers the view that the city is left with.
    fn leave(&mut self) {
        if let Some(running) = self.running.take() {
            remember_view(self.options.city.folder(), running.key());
        }
    }

    fn open(&mut self, events: &ActiveEventLoop) {
        match Running::open(events, &self.options) {
            Ok(running) => self.running = Some(running),
            Err(error) => self.fail(events, error),
        }
    }

    /// Shows another city, whose folder was dropped on the window.
    fn open_city(&mut self, events: &ActiveEventLoop, folder: &std::path::Path) {
        match City::open(folder) {
            Ok(city) => {
                self.leave();
                self.options.clock.move_to(city.manifest().place);
                (self.options.city, self.options.pose, self.options.path) = (city, None, None);
                self.open(events);
            }
            Err(error) => {
                if let Some(running) = &mut self.running {
                    running.tell(format!(
                        "{error}; drop the folder of a city, and import survey files with rilievo import"
                    ));
                }
            }
        }
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.running.is_none() {
            self.open(events);
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        let Some(running) = &mut self.running else { return };
        if running.screen.window.id() != window {
            return;
        }
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::DroppedFile(path) => self.open_city(events, &path),
            WindowEvent::RedrawRequested => {
                let drawn = running.draw();
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
                    Err(error) => running.tell(error.to_string()),
                },
                Err(error) => running.tell(error.to_string()),
            }
            running.take_over_edits();
        }
        running.take_outcomes();
        if running.wants_frame() {
            running.screen.window.request_redraw();
        }
        events.set_control_flow(ControlFlow::WaitUntil(running.wakes_at(CHECK_INTERVAL)));
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.leave();
    }
}
