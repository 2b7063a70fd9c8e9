//! The keys and what the mouse does.

/// One a line: what to press, and what it does.
const KEYS: [(&str, &str); 20] = [
    ("left drag", "move the ground under the cursor"),
    ("right drag, Ctrl + drag", "turn round the point under the cursor"),
    ("wheel, two fingers", "go to the point under the cursor"),
    ("two fingers, turned", "turn the city (touchpad)"),
    ("click", "select a building"),
    ("double click", "fly there"),
    ("W A S D", "fly ahead, left, back, right"),
    ("Q E", "down, up"),
    ("Shift", "five times as fast"),
    ("N", "north up"),
    ("M", "measure"),
    ("B", "draw a building; Enter builds it"),
    ("Del", "delete the selected building"),
    ("Ctrl Z, Ctrl Shift Z", "undo, redo"),
    ("K", "the view as a key of the flight"),
    ("R", "record a flight"),
    ("Space", "play, pause"),
    ("P", "save an image, depth and ids"),
    ("Tab", "hide the panels"),
    ("Esc", "put the tool down; close"),
];

/// Lays it out, when it is wanted.
pub fn show(context: &egui::Context, is_open: &mut bool) {
    if !*is_open {
        return;
    }
    egui::Window::new("Keys")
        .anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0])
        .resizable(false)
        .collapsible(false)
        .open(is_open)
        .show(context, |ui| {
            egui::Grid::new("keys")
                .num_columns(2)
                .spacing([18.0, 3.0])
                .show(ui, |ui| {
                    for (key, what) in KEYS {
                        ui.monospace(key);
                        ui.label(what);
                        ui.end_row();
                    }
                });
        });
}
