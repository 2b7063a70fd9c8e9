//! The selected building: what the dataset says of it, and what can be done with it.

use super::{Action, Interface, PanelInfo};
use crate::city::Edit;
use crate::viewer::editing::EditCommand;
use crate::viewer::tools::Tool;

/// Heights that can be given, metres.
const HEIGHTS_M: std::ops::RangeInclusive<f64> = 1.0..=1000.0;

/// Width of the panel, points.
const WIDTH: f32 = 230.0;

/// Lays it out, when there is one.
pub fn show(
    context: &egui::Context,
    interface: &mut Interface,
    info: &PanelInfo<'_>,
    actions: &mut Vec<Action>,
) {
    let Some(selection) = &mut interface.selection else {
        return;
    };
    let building = &selection.details.building;
    let (fid, height_m) = (building.fid, building.roof_m - building.base_m);
    let mut is_open = true;
    egui::Window::new(format!("Building {fid}"))
        .id(egui::Id::unique("building"))
        .anchor(egui::Align2::RIGHT_TOP, [-12.0, 12.0])
        .resizable(false)
        .default_width(WIDTH)
        .open(&mut is_open)
        .show(context, |ui| {
            ui.set_width(WIDTH);
            egui::Grid::new("figures").num_columns(2).show(ui, |ui| {
                for (name, value) in [
                    ("height", format!("{height_m:.2} m")),
                    ("roof", format!("{:.2} m", building.roof_m)),
                    ("base", format!("{:.2} m", building.base_m)),
                    ("area", format!("{:.1} m²", selection.area_m2)),
                ] {
                    ui.label(name);
                    ui.monospace(value);
                    ui.end_row();
                }
            });
            ui.separator();
            ui.horizontal(|ui| {
                let value = egui::DragValue::new(&mut selection.height_m)
                    .range(HEIGHTS_M)
                    .speed(0.1)
                    .suffix(" m");
                ui.add(value);
                let is_other = (selection.height_m - height_m).abs() > 5e-3;
                if ui
                    .add_enabled(is_other, egui::Button::new("Set height"))
                    .clicked()
                {
                    let height_m = selection.height_m;
                    actions.push(Action::Edit(EditCommand::Apply(Edit::Height { fid, height_m })));
                }
            });
            ui.horizontal(|ui| {
                let is_changing = interface.tool == Tool::Change;
                if ui
                    .selectable_label(is_changing, "Move")
                    .on_hover_text("drag it, or a corner of its roof")
                    .clicked()
                {
                    interface.tool = if is_changing { Tool::Look } else { Tool::Change };
                }
                if ui.button("Delete").clicked() {
                    actions.push(Action::Edit(EditCommand::Apply(Edit::Delete { fid })));
                }
                if ui.button("Fly there").clicked() {
                    actions.push(Action::FlyToSelection);
                }
            });
            if info.edits.1 {
                ui.small("updating …");
            }
            ui.separator();
            egui::ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
                egui::Grid::new("attributes")
                    .num_columns(2)
                    .striped(true)
                    .show(ui, |ui| {
                        for (name, value) in &selection.details.attributes {
                            ui.small(name);
                            ui.add(egui::Label::new(egui::RichText::new(value).small()).wrap());
                            ui.end_row();
                        }
                    });
            });
        });
    if !is_open {
        interface.selection = None;
        interface.tool = Tool::Look;
    }
}
