//! The tools in hand: look, measure, draw, change; undo and redo.

use super::{Action, Interface, PanelInfo};
use crate::viewer::editing::EditCommand;
use crate::viewer::tools::Tool;

/// Heights of a building that is drawn, metres.
const HEIGHTS_M: std::ops::RangeInclusive<f64> = 1.0..=500.0;

/// Lays it out.
pub fn show(ui: &mut egui::Ui, interface: &mut Interface, info: &PanelInfo<'_>, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        for (tool, name) in [
            (Tool::Look, "look"),
            (Tool::Measure, "measure  M"),
            (Tool::Draw, "draw  B"),
        ] {
            ui.selectable_value(&mut interface.tool, tool, name);
        }
    });
    match interface.tool {
        Tool::Look => {
            ui.small("Click a building to see what the dataset says of it.");
        }
        Tool::Measure => measure(ui, interface),
        Tool::Draw => draw(ui, interface, actions),
        Tool::Change => {
            ui.small("Drag the building, or a corner of its roof. Esc ends.");
        }
    }
    let ([undos, redos], is_busy) = info.edits;
    ui.horizontal(|ui| {
        if ui
            .add_enabled(undos > 0, egui::Button::new(format!("Undo ({undos})")))
            .clicked()
        {
            actions.push(Action::Edit(EditCommand::Undo));
        }
        if ui
            .add_enabled(redos > 0, egui::Button::new(format!("Redo ({redos})")))
            .clicked()
        {
            actions.push(Action::Edit(EditCommand::Redo));
        }
        if is_busy {
            ui.small("updating …");
        }
    });
}

fn measure(ui: &mut egui::Ui, interface: &mut Interface) {
    let measure = &mut interface.measure;
    if measure.points.is_empty() {
        ui.small("Click points of the city.");
        return;
    }
    let [plan, space] = measure.lengths();
    ui.monospace(format!(
        "in plan   {plan:>10.2} m\nin space  {space:>10.2} m\nrise      {:>10.2} m",
        measure.rise()
    ));
    if let Some(area) = measure.area() {
        ui.monospace(format!("area      {area:>10.1} m²"));
    }
    if ui.small_button("Clear").clicked() {
        measure.points.clear();
    }
}

fn draw(ui: &mut egui::Ui, interface: &mut Interface, actions: &mut Vec<Action>) {
    let draft = &mut interface.draft;
    ui.small("Click the corners of the footprint on the ground, then Enter.");
    ui.horizontal(|ui| {
        ui.add(
            egui::DragValue::new(&mut draft.height_m)
                .range(HEIGHTS_M)
                .speed(0.1)
                .suffix(" m high"),
        );
        let is_ready = draft.points.len() >= 3;
        if ui.add_enabled(is_ready, egui::Button::new("Build")).clicked() {
            actions.push(Action::Build);
        }
        if ui.small_button("Clear").clicked() {
            draft.points.clear();
        }
    });
}
