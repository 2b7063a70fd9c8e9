//! The timeline of the flight: keys, recording, playing.

use super::Action;
use crate::viewer::recorder::Recorder;

/// Lays it out.
pub fn show(ui: &mut egui::Ui, recorder: &mut Recorder, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        if ui
            .button("Key  K")
            .on_hover_text("this view, as the next key")
            .clicked()
        {
            actions.push(Action::AddKey);
        }
        let record = if recorder.is_recording() {
            "Stop"
        } else {
            "Record  R"
        };
        if ui.button(record).clicked() {
            recorder.toggle_recording();
        }
        let play = if recorder.is_playing { "Pause" } else { "Play" };
        if ui.button(play).clicked() {
            recorder.toggle_playing();
        }
        if ui.button("Save").on_hover_text("for rilievo film").clicked() {
            actions.push(Action::SaveFlight);
        }
    });
    let [first, last] = recorder.span();
    if last > first {
        ui.spacing_mut().slider_width = 170.0;
        let slider = egui::Slider::new(&mut recorder.time_s, first..=last).suffix(" s");
        if ui.add(slider).changed() {
            recorder.is_playing = false;
            actions.push(Action::ShowFlight);
        }
    }
    let mut removed = None;
    let mut moved = false;
    let times: Vec<f64> = recorder.path.times().collect();
    egui::ScrollArea::vertical().max_height(120.0).show(ui, |ui| {
        for (index, &time) in times.iter().enumerate() {
            ui.horizontal(|ui| {
                // Between its neighbours, so that times go on increasing.
                let low = index
                    .checked_sub(1)
                    .and_then(|k| times.get(k))
                    .map_or(f64::MIN, |time| time + 0.05);
                let high = times.get(index + 1).map_or(f64::MAX, |time| time - 0.05);
                let mut at = time;
                let value = egui::DragValue::new(&mut at)
                    .speed(0.05)
                    .suffix(" s")
                    .max_decimals(2);
                if ui.add(value).changed()
                    && let Some(key) = recorder.path.keys.get_mut(index)
                {
                    key.t = Some(at.max(low).min(high));
                    moved = true;
                }
                if ui.small_button("×").clicked() {
                    removed = Some(index);
                }
            });
        }
    });
    if moved {
        recorder.changed();
    }
    if let Some(index) = removed {
        recorder.remove(index);
    }
}
