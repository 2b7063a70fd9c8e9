//! The panel: time of day, lens, frame time, and what the mouse does.

use std::sync::Arc;

use super::clock::hour_text;
use super::pace::MAX_SAMPLES;
use super::scene_state::SceneState;
use crate::camera::lens::Lens;

/// What the panel shows beside the state that it changes.
pub struct PanelInfo<'a> {
    /// Name of the city.
    pub city: &'a str,
    /// The graphics device.
    pub device: &'a str,
    /// Milliseconds of the last frame.
    pub frame_ms: f64,
    /// Pixels of the last frame.
    pub frame: [u32; 2],
    /// Samples of the image shown.
    pub samples: u32,
    /// A line about the last thing done, such as a file written.
    pub message: &'a str,
    /// Lenses to choose from.
    pub lenses: &'a [Arc<Lens>],
}

/// f-numbers of the slider.
const F_NUMBERS: std::ops::RangeInclusive<f64> = 1.4..=32.0;
/// f-number of a lens just put in.
const FIRST_F_NUMBER: f64 = 8.0;
/// Colour of the marks of sunrise and sunset.
const SUN_MARK: egui::Color32 = egui::Color32::from_rgb(255, 176, 60);

/// Lays the panel out; true when the view changed.
pub fn panel(ui: &mut egui::Ui, state: &mut SceneState, info: &PanelInfo<'_>) -> bool {
    let mut changed = false;
    ui.set_width(250.0);
    changed |= time(ui, state);
    ui.separator();
    changed |= lens(ui, state, info.lenses);
    ui.separator();
    let [width, height] = info.frame;
    ui.label(format!(
        "{:.0} ms   {width} x {height}   {} of {MAX_SAMPLES} samples",
        info.frame_ms, info.samples
    ));
    ui.small(info.device);
    ui.collapsing("Keys", |ui| {
        ui.small("left drag: pan    right drag: orbit    wheel: zoom");
        ui.small("W A S D, Q E: fly    Shift: faster");
        ui.small("N: north up    P: PNG    Tab: hide this panel    Esc: close");
    });
    if !info.message.is_empty() {
        ui.small(info.message);
    }
    changed
}

/// The time of day, sunrise and sunset marked.
fn time(ui: &mut egui::Ui, state: &mut SceneState) -> bool {
    ui.label(state.clock.label());
    ui.spacing_mut().slider_width = 160.0;
    let slider = egui::Slider::new(&mut state.clock.hours, 0.0..=24.0)
        .custom_formatter(|hours, _| hour_text(hours))
        .custom_parser(|text| {
            let (hours, minutes) = text.split_once(':').unwrap_or((text, "0"));
            Some(hours.trim().parse::<f64>().ok()? + minutes.trim().parse::<f64>().ok()? / 60.0)
        });
    let response = ui.add(slider);
    if let Some(sunrise_sunset) = state.clock.sunrise_sunset {
        let rail = response.rect.left()..=response.rect.left() + 160.0;
        for hours in sunrise_sunset {
            let x = egui::lerp(rail.clone(), (hours / 24.0) as f32);
            let mark = egui::Stroke::new(2.0, SUN_MARK);
            ui.painter().vline(x, response.rect.y_range(), mark);
        }
        let [sunrise, sunset] = sunrise_sunset.map(hour_text);
        ui.small(format!("sunrise {sunrise}   sunset {sunset}"));
    }
    response.changed()
}

/// The lens and its f-number.
fn lens(ui: &mut egui::Ui, state: &mut SceneState, lenses: &[Arc<Lens>]) -> bool {
    let mut changed = false;
    let f_number = match &state.optics {
        crate::camera::Optics::Lens(lens) => Some(lens.f_number),
        crate::camera::Optics::Pinhole { .. } => None,
    };
    let shown = state.lens_name().unwrap_or("pinhole").to_owned();
    egui::ComboBox::from_label("lens")
        .selected_text(&shown)
        .show_ui(ui, |ui| {
            if ui
                .selectable_label(state.lens_name().is_none(), "pinhole")
                .clicked()
            {
                state.use_pinhole();
                changed = true;
            }
            for lens in lenses {
                if ui.selectable_label(shown == lens.name, &lens.name).clicked() {
                    state.use_lens(Arc::clone(lens), f_number.unwrap_or(FIRST_F_NUMBER));
                    changed = true;
                }
            }
        });
    if let crate::camera::Optics::Lens(optics) = &mut state.optics {
        let slider = egui::Slider::new(&mut optics.f_number, F_NUMBERS)
            .logarithmic(true)
            .text("f-number");
        changed |= ui.add(slider).changed();
    }
    let exposure = egui::Slider::new(&mut state.exposure_stops, -4.0..=4.0).text("exposure, stops");
    changed |= ui.add(exposure).changed();
    changed
}
