//! A search: a coordinate to go to, or a value of an attribute.

use super::{Action, Interface};

/// Lays it out.
pub fn show(ui: &mut egui::Ui, interface: &mut Interface, actions: &mut Vec<Action>) {
    let edit = egui::TextEdit::singleline(&mut interface.find_text)
        .hint_text("E, N  or  lat, lon  or  an attribute's value");
    let response = ui.add(edit);
    let is_entered = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    if is_entered && !interface.find_text.trim().is_empty() {
        actions.push(Action::Find(interface.find_text.clone()));
    }
    egui::ScrollArea::vertical().max_height(140.0).show(ui, |ui| {
        for (fid, value) in &interface.found {
            if ui.selectable_label(false, format!("{fid}: {value}")).clicked() {
                actions.push(Action::Show(*fid));
            }
        }
    });
}
