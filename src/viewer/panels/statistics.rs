//! Frame times, passes, bytes, reads.

use std::collections::VecDeque;

use super::PanelInfo;
use crate::gpu::PassTimes;
use crate::viewer::pace::MAX_SAMPLES;

/// What is measured.
#[derive(Default)]
pub struct Statistics {
    /// Milliseconds of the last frames, the newest last.
    frames_ms: VecDeque<f64>,
    /// Milliseconds of the last frame's passes.
    pub passes: PassTimes,
    /// Bytes of the resident tiles on the device, and of the building maps among them; tiles.
    pub resident: [u64; 3],
    /// Reads of the building map a ray of the last image.
    pub reads_per_ray: Option<f64>,
    /// Whether the panel is open: what costs time is measured only then.
    pub is_shown: bool,
}

/// Frames of the plot.
const FRAMES: usize = 120;
const PLOT_HEIGHT: f32 = 44.0;

impl Statistics {
    /// A frame was drawn.
    pub fn add_frame(&mut self, ms: f64) {
        if self.frames_ms.len() == FRAMES {
            self.frames_ms.pop_front();
        }
        self.frames_ms.push_back(ms);
    }

    /// Milliseconds of the last frame.
    pub fn frame_ms(&self) -> f64 {
        self.frames_ms.back().copied().unwrap_or_default()
    }

    /// Lays it out.
    pub fn show(&mut self, ui: &mut egui::Ui, info: &PanelInfo<'_>) {
        self.is_shown = true;
        let [width, height] = info.frame;
        ui.label(format!(
            "{:.0} ms   {width} x {height}   {} of {MAX_SAMPLES} samples",
            self.frame_ms(),
            info.samples
        ));
        self.plot(ui);
        for (name, ms) in &self.passes {
            ui.monospace(format!("{name:<12}{ms:>8.1} ms"));
        }
        let megabytes = |bytes: u64| bytes as f64 * 1e-6;
        let [bytes, maps, tiles] = self.resident;
        ui.monospace(format!(
            "tiles       {tiles:>8}\nresident    {:>8.1} MB\nbuildings   {:>8.1} MB",
            megabytes(bytes),
            megabytes(maps)
        ));
        if let Some(reads) = self.reads_per_ray {
            ui.monospace(format!("reads a ray {reads:>8.1}"));
        }
        ui.small(info.device);
    }

    /// The times of the last frames as a line, the longest at its top.
    fn plot(&self, ui: &mut egui::Ui) {
        let (response, painter) = ui.allocate_painter(
            egui::vec2(ui.available_width(), PLOT_HEIGHT),
            egui::Sense::hover(),
        );
        let rect = response.rect;
        painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
        let longest = self.frames_ms.iter().copied().fold(1.0, f64::max);
        let point = |(k, ms): (usize, &f64)| {
            let x = rect.left() + rect.width() * k as f32 / (FRAMES - 1) as f32;
            egui::pos2(x, rect.bottom() - rect.height() * (ms / longest) as f32)
        };
        let points: Vec<egui::Pos2> = self.frames_ms.iter().enumerate().map(point).collect();
        painter.line(points, egui::Stroke::new(1.0, ui.visuals().text_color()));
        let text = format!("{longest:.0} ms");
        painter.text(
            rect.left_top(),
            egui::Align2::LEFT_TOP,
            text,
            egui::TextStyle::Small.resolve(ui.style()),
            ui.visuals().weak_text_color(),
        );
    }
}
