//! The lens, its f-number, and what of its flare is drawn.

use std::sync::Arc;

use super::Action;
use crate::camera::flare::{GhostParameters, Quality};
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::{Optics, Paraxial, single_crossing_ghosts};
use crate::viewer::scene_state::SceneState;

/// f-numbers of the slider; no wider than the lens.
const F_NUMBERS: std::ops::RangeInclusive<f64> = 1.4..=32.0;
/// f-number of a lens just put in.
const FIRST_F_NUMBER: f64 = 8.0;
/// Fields of view of the pinhole, degrees.
const FIELDS_DEG: std::ops::RangeInclusive<f64> = 10.0..=110.0;

/// Lays it out.
pub fn show(ui: &mut egui::Ui, state: &mut SceneState, lenses: &[Arc<Lens>], actions: &mut Vec<Action>) {
    let mut changed = false;
    let f_number = match &state.optics {
        Optics::Lens(lens) => Some(lens.f_number),
        Optics::Pinhole { .. } => None,
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
    match &mut state.optics {
        Optics::Lens(optics) => {
            let widest = Paraxial::new(&optics.lens, D_LINE_UM, None).widest_f_number(&optics.lens);
            let f_numbers = widest.unwrap_or(*F_NUMBERS.start())..=*F_NUMBERS.end();
            let slider = egui::Slider::new(&mut optics.f_number, f_numbers)
                .logarithmic(true)
                .text("f-number");
            changed |= ui.add(slider).changed();
            ui.horizontal(|ui| {
                changed |= ui.checkbox(&mut state.shows_flare, "flare").changed();
                if let Some(flare) = &mut state.flare {
                    let mut has_ghosts = flare.ghosts.is_some();
                    if ui.checkbox(&mut has_ghosts, "ghosts").changed() {
                        flare.ghosts = has_ghosts.then(|| Quality::Low.preset().ghosts());
                        changed = true;
                    }
                }
            });
            if let Some(ghosts) = state.flare.as_mut().and_then(|flare| flare.ghosts.as_mut()) {
                changed |= single_ghost(ui, &optics.lens, ghosts);
            }
        }
        Optics::Pinhole { fov_y } => {
            let mut degrees = fov_y.to_degrees();
            let slider = egui::Slider::new(&mut degrees, FIELDS_DEG).text("field of view, degrees");
            if ui.add(slider).changed() {
                *fov_y = degrees.to_radians();
                changed = true;
            }
        }
    }
    if changed {
        actions.push(Action::Redraw);
    }
}

/// A slider over the ghosts that are drawn: all of them, or one alone.
fn single_ghost(ui: &mut egui::Ui, lens: &Lens, parameters: &mut GhostParameters) -> bool {
    let ghosts = single_crossing_ghosts(lens);
    // 0 = all.
    let mut shown = parameters
        .only
        .and_then(|only| ghosts.iter().position(|ghost| *ghost == only))
        .map_or(0, |index| index + 1);
    let slider =
        egui::Slider::new(&mut shown, 0..=ghosts.len()).custom_formatter(|shown, _| match shown as usize {
            0 => "all".to_owned(),
            k => {
                let reflected = ghosts.get(k - 1).map(|ghost| [ghost.first + 1, ghost.second + 1]);
                reflected.map_or(String::new(), |[first, second]| {
                    format!("surfaces {first}, {second}")
                })
            }
        });
    let is_changed = ui.add(slider.text("ghost")).changed();
    parameters.only = shown.checked_sub(1).and_then(|index| ghosts.get(index)).copied();
    is_changed
}
