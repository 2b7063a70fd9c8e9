//! The window before a city is open: cities opened before, the sample city, and the import of survey files that are dropped on it.

mod import_form;
mod job;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use import_form::ImportForm;
use job::Job;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::ActiveEventLoop;
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::Window;

use super::ViewerError;
use super::last_view::{data_folder, recent_cities};
use super::screen::Screen;
use crate::city::ImportStage;
use crate::gpu::Gpu;
use crate::output::RenderError;

/// The window.
pub struct StartScreen {
    screen: Screen,
    gpu: Gpu,
    recent: Vec<PathBuf>,
    form: ImportForm,
    job: Option<Job>,
    message: String,
    /// Whether the user closed it.
    pub is_closed: bool,
}

/// What the user wants.
enum Wish {
    Open(PathBuf),
    MakeSample,
    Import,
}

const WIDTH: f32 = 560.0;

impl StartScreen {
    /// Opens the window, with survey files to look at.
    ///
    /// # Errors
    /// When there is no display or no device.
    pub fn open(events: &ActiveEventLoop, size: [u32; 2], files: &[PathBuf]) -> Result<Self, ViewerError> {
        let no_window = |why: String| ViewerError::NoWindow { why };
        let attributes = Window::default_attributes()
            .with_title("Rilievo")
            .with_inner_size(PhysicalSize::new(size[0], size[1]));
        let window = events
            .create_window(attributes)
            .map_err(|error| no_window(error.to_string()))?;
        let window = Arc::new(window);
        let (gpu, surface, configuration) =
            Gpu::open_for_window(Arc::clone(&window)).map_err(RenderError::from)?;
        let mut start = Self {
            screen: Screen::new(&gpu, window, surface, configuration),
            gpu,
            recent: recent_cities(),
            form: ImportForm::default(),
            job: None,
            message: String::new(),
            is_closed: false,
        };
        for file in files {
            start.drop_file(file);
        }
        start.screen.window.request_redraw();
        Ok(start)
    }

    /// Whether a window is this one.
    pub fn is(&self, window: winit::window::WindowId) -> bool {
        self.screen.window.id() == window
    }

    /// A file was dropped on the window, which is no city.
    pub fn drop_file(&mut self, path: &Path) {
        self.message = self
            .form
            .add(path)
            .err()
            .map_or(String::new(), |error| error.to_string());
        self.screen.window.request_redraw();
    }

    /// Shows why a city could not be opened.
    pub fn tell(&mut self, text: String) {
        self.message = text;
        self.screen.window.request_redraw();
    }

    /// An event of the window; the folder of a city to open.
    pub fn on_event(&mut self, event: &WindowEvent) -> Option<PathBuf> {
        let Screen { window, overlay, .. } = &mut self.screen;
        overlay.on_event(window, event);
        match event {
            WindowEvent::Resized(size) => self.screen.resize(&self.gpu, [size.width, size.height]),
            WindowEvent::RedrawRequested => return self.draw(),
            WindowEvent::KeyboardInput { event, .. }
                if event.physical_key == PhysicalKey::Code(KeyCode::Escape) =>
            {
                self.is_closed = true;
            }
            _ => {}
        }
        self.screen.window.request_redraw();
        None
    }

    /// Whether something goes on that is to be shown.
    pub fn is_busy(&self) -> bool {
        self.job.is_some() || self.screen.overlay.is_animated()
    }

    /// Has the window drawn again.
    pub fn redraw(&self) {
        self.screen.window.request_redraw();
    }

    fn draw(&mut self) -> Option<PathBuf> {
        if let Some(made) = self.job.as_ref().and_then(Job::result) {
            self.job = None;
            match made {
                Ok(city) => return Some(city),
                Err(why) => self.message = why,
            }
        }
        let (form, recent, message, job) = (&mut self.form, &self.recent, &self.message, self.job.as_ref());
        let size = self.screen.size();
        let Screen { window, overlay, .. } = &mut self.screen;
        let mut wish = None;
        overlay.paint(&self.gpu, window, size, |context| {
            egui::Window::new("start")
                .title_bar(false)
                .anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0])
                .resizable(false)
                .collapsible(false)
                .default_width(WIDTH)
                .show(context, |ui| {
                    ui.set_width(WIDTH);
                    ui.add_space(8.0);
                    ui.heading("Rilievo");
                    ui.small("Survey data in, a true city out.");
                    ui.add_space(10.0);
                    wish = layout(ui, (form, recent), message, job);
                });
        });
        self.screen.draw(&self.gpu, None);
        match wish {
            Some(Wish::Open(city)) => return Some(city),
            Some(Wish::MakeSample) => self.make_sample(),
            Some(Wish::Import) => match self.form.options() {
                Ok(options) => self.job = Some(Job::import(options)),
                Err(why) => self.message = why,
            },
            None => {}
        }
        if self.job.is_some() {
            self.message.clear();
            self.screen.window.request_redraw();
        }
        None
    }

    fn make_sample(&mut self) {
        match data_folder() {
            Some(folder) => self.job = Some(Job::sample(&folder.join("sample"))),
            None => self.message = "no home folder to put the sample city into; run tools/demo".to_owned(),
        }
    }
}

fn layout(
    ui: &mut egui::Ui,
    (form, recent): (&mut ImportForm, &[PathBuf]),
    message: &str,
    job: Option<&Job>,
) -> Option<Wish> {
    let mut wish = None;
    if let Some(job) = job {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(job.text());
        });
        if let Some(ImportStage { name, done, total }) = job.stage() {
            let total_text = total.map_or(String::new(), |total| format!(" of {total}"));
            let part = total.map_or(0.0, |total| done as f32 / total.max(1) as f32);
            let bar = egui::ProgressBar::new(part).desired_width(WIDTH);
            ui.add(bar.text(format!("{name}: {done}{total_text}")));
        }
        return None;
    }
    if form.is_empty() {
        ui.label("Drop the folder of a city here, or survey files: terrain, buildings, orthophotos.");
        ui.add_space(6.0);
        if ui
            .button("Sample city")
            .on_hover_text("made by the program; takes some seconds the first time")
            .clicked()
        {
            wish = Some(Wish::MakeSample);
        }
        if !recent.is_empty() {
            ui.separator();
            ui.strong("Opened before");
            egui::ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
                for city in recent {
                    let name = city
                        .file_name()
                        .unwrap_or_default()
                        .to_string_lossy()
                        .into_owned();
                    let shown = ui.selectable_label(false, format!("{name}    {}", city.display()));
                    if shown.clicked() {
                        wish = Some(Wish::Open(city.clone()));
                    }
                }
            });
        }
    } else if form.show(ui) {
        wish = Some(Wish::Import);
    }
    if !message.is_empty() {
        ui.separator();
        ui.colored_label(ui.visuals().warn_fg_color, message);
    }
    wish
}
