//! The panels: what each shows and changes is in its own file. They change state, and ask for the rest by actions.

mod building;
mod edit;
mod find;
mod flight;
mod help;
mod layers;
mod lens;
mod picture;
mod statistics;
mod sun;

use std::sync::Arc;

use glam::DVec3;

pub use statistics::Statistics;

use super::editing::EditCommand;
use super::recorder::Recorder;
use super::scene_state::SceneState;
use super::tools::{Draft, Measure, Selection, Tool};
use crate::camera::lens::Lens;

/// What the panels show beside the state that they change.
pub struct PanelInfo<'a> {
    /// Name of the city.
    pub city: &'a str,
    /// The graphics device.
    pub device: &'a str,
    /// Pixels of the last frame.
    pub frame: [u32; 2],
    /// Samples of the image shown.
    pub samples: u32,
    /// A line about the last thing done, such as a file written.
    pub message: &'a str,
    /// Lenses to choose from.
    pub lenses: &'a [Arc<Lens>],
    /// The fraction of the view's tiles that are there.
    pub loaded: f32,
    /// Edits that can be taken back and made again; whether one is under way.
    pub edits: ([usize; 2], bool),
    /// What is under the cursor, in words.
    pub under_cursor: &'a str,
}

/// What the panels hold of their own.
#[derive(Default)]
pub struct Interface {
    /// The tool in hand.
    pub tool: Tool,
    /// The building selected.
    pub selection: Option<Selection>,
    /// What is measured.
    pub measure: Measure,
    /// The footprint in the drawing.
    pub draft: Draft,
    /// The flight.
    pub recorder: Recorder,
    /// Frame times and the like.
    pub statistics: Statistics,
    /// Text of the search, and what it found: ids and values.
    pub find_text: String,
    /// What it found.
    pub found: Vec<(u32, String)>,
    /// Whether the panels are hidden.
    pub is_hidden: bool,
    /// Whether the list of keys is shown.
    pub shows_help: bool,
}

/// What a panel asks for.
#[derive(Clone, Debug)]
pub enum Action {
    /// The image is another one.
    Redraw,
    /// The date or hour is another one.
    SetSun,
    /// An edit of the city.
    Edit(EditCommand),
    /// Fly to the selected building.
    FlyToSelection,
    /// Select a building and fly there.
    Show(u32),
    /// Search an attribute value, or go to a coordinate.
    Find(String),
    /// Close the drawing and build it.
    Build,
    /// Add the view as a key of the flight.
    AddKey,
    /// Show the view of the timeline.
    ShowFlight,
    /// Save the flight beside the images.
    SaveFlight,
    /// Save an image, with depth and ids.
    SaveImage,
    /// Show or hide the list of keys.
    ToggleHelp,
}

/// Width of the main panel, points.
const WIDTH: f32 = 250.0;

/// Lays all panels out over an image; what they ask for.
pub fn show(
    context: &egui::Context,
    state: &mut SceneState,
    interface: &mut Interface,
    info: &PanelInfo<'_>,
) -> Vec<Action> {
    let mut actions = Vec::new();
    if interface.is_hidden {
        return actions;
    }
    main_panel(context, state, interface, info, &mut actions);
    building::show(context, interface, info, &mut actions);
    status_line(context, info);
    help::show(context, &mut interface.shows_help);
    actions
}

fn main_panel(
    context: &egui::Context,
    state: &mut SceneState,
    interface: &mut Interface,
    info: &PanelInfo<'_>,
    actions: &mut Vec<Action>,
) {
    egui::Window::new(info.city)
        .anchor(egui::Align2::LEFT_TOP, [12.0, 12.0])
        .resizable(false)
        .default_width(WIDTH)
        .show(context, |ui| {
            ui.set_width(WIDTH);
            sun::show(ui, state, actions);
            ui.separator();
            egui::CollapsingHeader::new("Layers").show(ui, |ui| layers::show(ui, state, actions));
            egui::CollapsingHeader::new("Lens").show(ui, |ui| lens::show(ui, state, info.lenses, actions));
            egui::CollapsingHeader::new("Picture").show(ui, |ui| picture::show(ui, state, actions));
            egui::CollapsingHeader::new("Edit and measure")
                .show(ui, |ui| edit::show(ui, interface, info, actions));
            egui::CollapsingHeader::new("Find").show(ui, |ui| find::show(ui, interface, actions));
            egui::CollapsingHeader::new("Flight")
                .show(ui, |ui| flight::show(ui, &mut interface.recorder, actions));
            egui::CollapsingHeader::new("Statistics").show(ui, |ui| interface.statistics.show(ui, info));
            ui.horizontal(|ui| {
                if ui.small_button("Keys  ?").clicked() {
                    interface.shows_help = !interface.shows_help;
                }
                ui.small(concat!("Rilievo ", env!("CARGO_PKG_VERSION")));
            });
            if info.loaded < 1.0 {
                ui.add(egui::ProgressBar::new(info.loaded).desired_height(3.0));
            }
            if !info.message.is_empty() {
                ui.small(info.message);
            }
        });
}

/// What is under the cursor, at the foot of the window.
fn status_line(context: &egui::Context, info: &PanelInfo<'_>) {
    if info.under_cursor.is_empty() {
        return;
    }
    egui::Area::new(egui::Id::unique("status"))
        .anchor(egui::Align2::LEFT_BOTTOM, [12.0, -10.0])
        .interactable(false)
        .show(context, |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(ui.ctx().content_rect().width() - 40.0);
                ui.small(info.under_cursor);
            });
        });
}

/// Where a selected building is: the middle of its roof.
pub fn roof_centre(selection: &Selection) -> DVec3 {
    let building = &selection.details.building;
    building.bounds().centre().extend(building.roof_m)
}
