//! Date and time of day, sunrise and sunset marked, and a time lapse.

use super::Action;
use crate::viewer::clock::hour_text;
use crate::viewer::scene_state::SceneState;

/// Colour of the marks of sunrise and sunset.
const SUN_MARK: egui::Color32 = egui::Color32::from_rgb(255, 176, 60);
const RAIL: f32 = 160.0;

/// Lays it out.
pub fn show(ui: &mut egui::Ui, state: &mut SceneState, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.label(state.clock.label());
        for (text, days) in [("−", -7), ("+", 7)] {
            if ui.small_button(text).on_hover_text("a week").clicked() {
                state.clock.add_days(days);
                actions.push(Action::SetSun);
            }
        }
        ui.checkbox(&mut state.is_time_lapse, "lapse")
            .on_hover_text("an hour every two seconds");
    });
    ui.spacing_mut().slider_width = RAIL;
    let slider = egui::Slider::new(&mut state.clock.hours, 0.0..=24.0)
        .custom_formatter(|hours, _| hour_text(hours))
        .custom_parser(|text| {
            let (hours, minutes) = text.split_once(':').unwrap_or((text, "0"));
            Some(hours.trim().parse::<f64>().ok()? + minutes.trim().parse::<f64>().ok()? / 60.0)
        });
    let response = ui.add(slider);
    if let Some(sunrise_sunset) = state.clock.sunrise_sunset {
        let rail = response.rect.left()..=response.rect.left() + RAIL;
        for hours in sunrise_sunset {
            let x = egui::lerp(rail.clone(), (hours / 24.0) as f32);
            let mark = egui::Stroke::new(2.0, SUN_MARK);
            ui.painter().vline(x, response.rect.y_range(), mark);
        }
        let [sunrise, sunset] = sunrise_sunset.map(hour_text);
        ui.small(format!("sunrise {sunrise}   sunset {sunset}"));
    }
    if response.changed() {
        actions.push(Action::SetSun);
    }
}
