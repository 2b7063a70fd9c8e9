//! The window's life: opened, handed its events, closed.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::WindowId;

use super::journal::Journal;
use super::last_view::remember_view;
use super::running::Running;
use super::start::StartScreen;
use super::{ViewerError, ViewerOptions};
use crate::city::City;

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
        stage: Stage::Begin,
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
    stage: Stage,
    failure: Option<ViewerError>,
}

/// What the window shows.
enum Stage {
    /// Nothing yet.
    Begin,
    /// A choice of cities.
    Start(Box<StartScreen>),
    /// A city.
    Running(Box<Running>),
}

impl App {
    fn fail(&mut self, events: &ActiveEventLoop, error: ViewerError) {
        self.failure = Some(error);
        events.exit();
    }

    /// Remembers the view that the city is left with.
    fn leave(&mut self) {
        if let (Stage::Running(running), Some(city)) = (&self.stage, &self.options.city) {
            remember_view(city.folder(), running.key());
        }
        self.stage = Stage::Begin;
    }

    fn open(&mut self, events: &ActiveEventLoop, files: &[PathBuf]) {
        let opened =
            match &self.options.city {
                Some(city) => Running::open(events, city, &self.options)
                    .map(|running| Stage::Running(Box::new(running))),
                None => StartScreen::open(events, self.options.size, files)
                    .map(|start| Stage::Start(Box::new(start))),
            };
        match opened {
            Ok(stage) => self.stage = stage,
            Err(error) => self.fail(events, error),
        }
    }

    /// Shows another city; when it is none, says so.
    fn open_city(&mut self, events: &ActiveEventLoop, folder: &Path) {
        match City::open(folder) {
            Ok(city) => {
                self.leave();
                if let Some(clock) = &mut self.options.clock {
                    clock.move_to(city.manifest().place);
                }
                (self.options.city, self.options.pose, self.options.path) = (Some(city), None, None);
                self.open(events, &[]);
            }
            Err(error) => match &mut self.stage {
                Stage::Start(start) => start.tell(error.to_string()),
                Stage::Running(running) => running.tell(error.to_string()),
                Stage::Begin => {}
            },
        }
    }

    /// Something was dropped on the window: a city, or a survey file to import.
    fn on_drop(&mut self, events: &ActiveEventLoop, path: &Path) {
        if path.join("city.toml").is_file() {
            return self.open_city(events, path);
        }
        if let Stage::Start(start) = &mut self.stage {
            return start.drop_file(path);
        }
        self.leave();
        self.options.city = None;
        self.open(events, &[path.to_owned()]);
    }

    /// Looks whether the city was updated, and has it follow.
    fn check(&mut self) {
        let (Stage::Running(running), Some(city)) = (&mut self.stage, &mut self.options.city) else {
            return;
        };
        if running.last_check.elapsed() >= CHECK_INTERVAL {
            running.last_check = Instant::now();
            // What cannot be read just now is looked at again.
            match city.updated() {
                Ok(None) => {}
                Ok(Some(newer)) => match running.follow(&newer) {
                    Ok(()) => *city = newer,
                    Err(error) => running.tell(error.to_string()),
                },
                Err(error) => running.tell(error.to_string()),
            }
            running.take_over_edits();
        }
        running.take_outcomes();
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if let Stage::Begin = self.stage {
            let files = std::mem::take(&mut self.options.files);
            self.open(events, &files);
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => return events.exit(),
            WindowEvent::DroppedFile(path) => return self.on_drop(events, &path),
            _ => {}
        }
        let wanted = match &mut self.stage {
            Stage::Start(start) if start.is(window) => start.on_event(&event),
            Stage::Running(running) if running.screen.window.id() == window => {
                if let WindowEvent::RedrawRequested = event {
                    let drawn = running.draw();
                    let written = drawn.and_then(|is_new| match &mut self.journal {
                        Some(journal) if is_new => journal.write(&running.record(self.started)),
                        _ => Ok(()),
                    });
                    if let Err(error) = written {
                        self.fail(events, error);
                    }
                } else if running.on_event(&event) {
                    events.exit();
                }
                None
            }
            _ => None,
        };
        if let Some(city) = wanted {
            self.open_city(events, &city);
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        self.check();
        let wakes = match &mut self.stage {
            Stage::Running(running) => {
                if running.wants_frame() {
                    running.screen.window.request_redraw();
                }
                running.wakes_at(CHECK_INTERVAL)
            }
            Stage::Start(start) => {
                if start.is_closed {
                    events.exit();
                }
                if start.is_busy() {
                    start.redraw();
                }
                Instant::now() + CHECK_INTERVAL
            }
            Stage::Begin => Instant::now() + CHECK_INTERVAL,
        };
        events.set_control_flow(ControlFlow::WaitUntil(wakes));
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.leave();
    }
}
