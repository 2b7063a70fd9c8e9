//! Which layers are drawn, and how the buildings.

use super::Action;
use crate::relief::ReliefMode;
use crate::viewer::scene_state::SceneState;

/// Lays it out.
pub fn show(ui: &mut egui::Ui, state: &mut SceneState, actions: &mut Vec<Action>) {
    let before = state.relief;
    let layers = &mut state.relief.layers;
    ui.horizontal(|ui| {
        ui.checkbox(&mut layers.buildings, "buildings");
        ui.checkbox(&mut layers.facades, "facades");
        ui.checkbox(&mut layers.imagery, "imagery");
        ui.checkbox(&mut layers.streets, "streets")
            .on_hover_text("guessed from the gaps between buildings, where no imagery shows the ground");
    });
    ui.horizontal(|ui| {
        let ways = [
            (
                ReliefMode::Exact,
                "exact",
                "the exact walk through the building map",
            ),
            (
                ReliefMode::Search,
                "search",
                "the search of KR 10-0738500 in slices",
            ),
            (
                ReliefMode::Polygons,
                "polygons",
                "triangles of the footprints, as a check",
            ),
        ];
        for (mode, name, what) in ways {
            ui.selectable_value(&mut state.relief.mode, mode, name)
                .on_hover_text(what);
        }
    });
    if state.relief.mode == ReliefMode::Search {
        let search = &mut state.relief.search;
        ui.add(
            egui::Slider::new(&mut search.slices, 4..=512)
                .logarithmic(true)
                .text("slices"),
        );
        ui.add(egui::Slider::new(&mut search.refinements, 0..=16).text("halvings"));
        ui.add(egui::Slider::new(&mut search.delta, 0.1..=8.0).text("delta, m"));
    }
    if state.relief != before {
        actions.push(Action::Redraw);
    }
}
