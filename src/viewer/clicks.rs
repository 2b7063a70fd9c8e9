//! What the pointer is over and what its clicks do, by the tool in hand.

use std::time::{Duration, Instant};

use geo::Area;
use glam::DVec3;

use super::editing::EditCommand;
use super::glide::Glide;
use super::running::Running;
use super::tools::{Grab, Mark, Selection, Tool, building_marks, line_mark, outline_marks};
use super::{Cursor, Navigator};
use crate::city::Edit;
use crate::relief::pick;

/// A press and release this near and this soon are a click; two clicks this soon a double one.
const CLICK_PIXELS: f64 = 4.0;
const CLICK: Duration = Duration::from_millis(600);
const DOUBLE_CLICK: Duration = Duration::from_millis(400);
/// A click this near the first corner closes a footprint.
const CLOSING_PIXELS: f64 = 10.0;

const HOVERED: egui::Color32 = egui::Color32::from_rgb(255, 214, 110);
const SELECTED: egui::Color32 = egui::Color32::from_rgb(70, 205, 255);
const DRAWN: egui::Color32 = egui::Color32::from_rgb(255, 120, 90);
const MEASURED: egui::Color32 = egui::Color32::from_rgb(190, 255, 130);

impl Running {
    fn point_under(&self) -> Option<DVec3> {
        let projection = self.projection();
        let cursor = Cursor {
            projection: &projection,
            position: self.pointer.position,
        };
        Navigator::point_under(&self.renderer.resident.tiles, cursor)
    }

    /// The building under the pointer; 0 without one.
    fn fid_under(&self) -> u32 {
        let projection = self.projection();
        let direction = projection.direction_at(self.pointer.position);
        let hit = pick(&self.renderer.resident.tiles, projection.pose.eye, direction);
        hit.map_or(0, |hit| hit.fid)
    }

    /// Looks at what is under the pointer, once it rests.
    pub(super) fn look_under_cursor(&mut self) {
        if !self.pointer.is_due() {
            return;
        }
        self.pointer.moved = None;
        if self.screen.overlay.is_used() {
            (self.pointer.hovered, self.pointer.label) = (None, String::new());
            return;
        }
        let (point, fid) = (self.point_under(), self.fid_under());
        if self.pointer.hovered.as_ref().map_or(0, |building| building.fid) != fid {
            self.pointer.hovered = match fid {
                0 => None,
                fid => self
                    .city
                    .building(fid)
                    .ok()
                    .flatten()
                    .map(|details| details.building),
            };
        }
        let place = match (&self.places, point) {
            (Some(places), Some(point)) => places.label(point),
            (None, Some(point)) => format!("E {:.2}  N {:.2}  H {:.2} m", point.x, point.y, point.z),
            _ => String::new(),
        };
        self.pointer.label = match fid {
            0 => place,
            fid => format!("{place}    building {fid}"),
        };
    }

    /// A button was pressed on the image; true when the tool took it and the camera stays.
    pub(super) fn on_press(&mut self) -> bool {
        self.pointer.pressed = Some((self.pointer.position, Instant::now()));
        let Some(selection) = self
            .interface
            .selection
            .as_ref()
            .filter(|_| self.interface.tool == Tool::Change)
        else {
            return false;
        };
        let building = &selection.details.building;
        let projection = self.projection();
        let grab = Grab::begin(building, &projection, self.pointer.position);
        // The building itself, or a corner of its roof.
        let is_held = |grab: &Grab| grab.is_vertex() || self.fid_under() == building.fid;
        self.pointer.grab = grab.filter(is_held);
        self.pointer.grab.is_some()
    }

    /// The pointer moved with the button down; true when the tool follows it.
    pub(super) fn on_drag(&mut self) -> bool {
        let projection = self.projection();
        match &mut self.pointer.grab {
            Some(grab) => {
                grab.follow(&projection, self.pointer.position);
                true
            }
            None => false,
        }
    }

    /// The button was let go.
    pub(super) fn on_release(&mut self) {
        let pressed = self.pointer.pressed.take();
        if let Some(grab) = self.pointer.grab.take() {
            let selected = self
                .interface
                .selection
                .as_ref()
                .map(|selection| selection.details.building.fid);
            if let Some(fid) = selected.filter(|_| grab.is_moved()) {
                let outline = grab.outline();
                self.edit(EditCommand::Apply(Edit::Outline { fid, outline }));
            }
            return;
        }
        let now = Instant::now();
        let is_click = pressed.is_some_and(|(from, when)| {
            from.distance(self.pointer.position) < CLICK_PIXELS && now.duration_since(when) < CLICK
        });
        if !is_click {
            return;
        }
        let is_double = self.pointer.clicked.is_some_and(|(from, when)| {
            from.distance(self.pointer.position) < CLICK_PIXELS && now.duration_since(when) < DOUBLE_CLICK
        });
        self.pointer.clicked = (!is_double).then_some((self.pointer.position, now));
        self.on_click(is_double);
        self.screen.window.request_redraw();
    }

    fn on_click(&mut self, is_double: bool) {
        let Some(point) = self.point_under() else { return };
        match self.interface.tool {
            Tool::Look | Tool::Change if is_double => {
                self.stop();
                self.glide = Some(Glide::towards(self.state.navigator.pose, point));
            }
            Tool::Look => {
                let fid = self.fid_under();
                self.select((fid != 0).then_some(fid));
            }
            Tool::Change => {}
            Tool::Measure => self.interface.measure.points.push(point),
            Tool::Draw => {
                let first = self.interface.draft.points.first().copied();
                let projection = self.projection();
                let closes = first.and_then(|first| super::tools::pixel_of(&projection, first));
                let is_closed = self.interface.draft.points.len() >= 3
                    && closes.is_some_and(|pixel| pixel.distance(self.pointer.position) < CLOSING_PIXELS);
                if is_closed {
                    self.build();
                } else {
                    self.interface.draft.points.push(point);
                }
            }
        }
    }

    /// Selects a building, or none.
    pub(super) fn select(&mut self, fid: Option<u32>) {
        let Some(fid) = fid else {
            self.interface.selection = None;
            self.interface.tool = Tool::Look;
            return;
        };
        match self.city.building(fid) {
            Ok(details) => self.interface.selection = details.map(Selection::new),
            Err(error) => self.tell(error.to_string()),
        }
        if self.interface.selection.is_none() {
            self.interface.tool = Tool::Look;
        }
    }

    /// Builds what was drawn.
    pub(super) fn build(&mut self) {
        let Some(outline) = self.interface.draft.outline() else {
            return;
        };
        if outline.unsigned_area() < 1.0 {
            self.tell("the footprint encloses less than a square metre; draw it again".to_owned());
            return;
        }
        let height_m = self.interface.draft.height_m;
        self.edit(EditCommand::Apply(Edit::Add { outline, height_m }));
        self.interface.draft.points.clear();
    }

    /// Lines over the image.
    pub(super) fn marks(&self) -> Vec<Mark> {
        let interface = &self.interface;
        let mut marks = Vec::new();
        if let Some(selection) = &interface.selection {
            let building = &selection.details.building;
            match &self.pointer.grab {
                Some(grab) => marks.extend(outline_marks(
                    &grab.outline(),
                    [building.base_m, grab.roof_m()],
                    SELECTED,
                )),
                None => marks.extend(building_marks(building, SELECTED)),
            }
            if interface.tool == Tool::Change {
                let corners = super::tools::corners(building);
                marks.extend(
                    corners
                        .into_iter()
                        .map(|corner| line_mark(vec![corner], SELECTED)),
                );
            }
        }
        let selected = interface
            .selection
            .as_ref()
            .map(|selection| selection.details.building.fid);
        if let Some(building) = self
            .pointer
            .hovered
            .as_ref()
            .filter(|building| Some(building.fid) != selected)
        {
            marks.extend(building_marks(building, HOVERED));
        }
        if !interface.measure.points.is_empty() {
            marks.push(line_mark(interface.measure.points.clone(), MEASURED));
        }
        if !interface.draft.points.is_empty() {
            marks.push(line_mark(interface.draft.points.clone(), DRAWN));
        }
        marks
    }
}
