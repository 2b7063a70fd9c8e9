//! How bright, and how finely drawn.

use super::Action;
use crate::viewer::pace::MAX_SAMPLES;
use crate::viewer::scene_state::SceneState;

/// Lays it out.
pub fn show(ui: &mut egui::Ui, state: &mut SceneState, actions: &mut Vec<Action>) {
    let exposure = egui::Slider::new(&mut state.exposure_stops, -4.0..=4.0).text("exposure, stops");
    if ui.add(exposure).changed() {
        actions.push(Action::Redraw);
    }
    let samples = egui::Slider::new(&mut state.max_samples, 1..=MAX_SAMPLES)
        .logarithmic(true)
        .text("samples at rest");
    if ui.add(samples).changed() {
        actions.push(Action::Redraw);
    }
    ui.add(egui::Slider::new(&mut state.frames_per_s, 5.0..=60.0).text("frames a second, moving"));
    if ui
        .button("Save image  P")
        .on_hover_text("with depth and building ids beside it")
        .clicked()
    {
        actions.push(Action::SaveImage);
    }
}
