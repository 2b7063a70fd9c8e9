//! What the panels and keys ask for, done.

use geo::BoundingRect;
use glam::DVec3;

use super::ViewerError;
use super::editing::EditCommand;
use super::glide::Glide;
use super::panels::{Action, roof_centre};
use super::running::Running;
use super::tools::Tool;
use crate::gpu::read_texture;
use crate::output::{RenderError, write_depth, write_ids, write_png};
use crate::space::Pose;

/// Buildings that a search lists.
const MAX_FOUND: usize = 50;
/// How a place that was searched for is looked at: from so far away by its extent, and at least so far, metres.
const EXTENTS_AWAY: f64 = 3.0;
const MIN_AWAY_M: f64 = 120.0;

impl Running {
    /// Does what was asked for.
    pub(super) fn act(&mut self, action: Action) -> Result<(), ViewerError> {
        match action {
            Action::Redraw => self.moved(),
            Action::SetSun => {
                self.state.sun = self.state.clock.sun()?;
                self.moved();
            }
            Action::Edit(command) => self.edit(command),
            Action::FlyToSelection => self.fly_to_selection(),
            Action::Show(fid) => {
                self.select(Some(fid));
                self.fly_to_selection();
            }
            Action::Find(text) => self.find(&text),
            Action::Build => self.build(),
            Action::AddKey => {
                self.interface.recorder.add(self.key());
                self.screen.window.request_redraw();
            }
            Action::ShowFlight => {
                if let Some(view) = self.interface.recorder.view() {
                    self.state.set_view(&view, self.city.manifest().place)?;
                    self.moved();
                }
            }
            Action::SaveFlight => {
                let text = self.save_flight();
                self.tell(text);
            }
            Action::SaveImage => self.saves_image = true,
            Action::ToggleHelp => self.interface.shows_help = !self.interface.shows_help,
        }
        Ok(())
    }

    /// Has an edit made.
    pub(super) fn edit(&mut self, command: EditCommand) {
        self.editing.send(command);
        self.screen.window.request_redraw();
    }

    /// Tells what came of edits; what was drawn is selected, what was deleted no longer is.
    pub(super) fn take_outcomes(&mut self) {
        while let Some(outcome) = self.editing.take() {
            self.tell(outcome.text);
            // The window itself follows the city folder, as for anybody's update.
            if let Some((fid, is_standing)) = outcome.building {
                self.select(is_standing.then_some(fid));
                self.last_check = std::time::Instant::now()
                    .checked_sub(std::time::Duration::from_secs(1))
                    .unwrap_or(self.last_check);
            }
        }
    }

    /// Has the city follow its footprint dataset, when another program wrote it and is done: the same twice.
    pub(super) fn take_over_edits(&mut self) {
        let edited = self.city.edited_dataset();
        let is_settled = edited.is_some() && edited == self.edited;
        if is_settled && !self.editing.is_busy() && self.taken_over != edited {
            self.taken_over = edited;
            self.edit(EditCommand::TakeOver);
        }
        self.edited = edited;
    }

    fn fly_to_selection(&mut self) {
        let Some(selection) = &self.interface.selection else {
            return;
        };
        let extent = selection.details.building.outline.bounding_rect();
        let extent_m = extent.map_or(0.0, |rect| rect.width().max(rect.height())) + selection.height_m;
        let target = roof_centre(selection);
        self.fly_to(target, extent_m);
    }

    /// Flies to what is so large, and looks at it from where the camera looks.
    fn fly_to(&mut self, target: DVec3, extent_m: f64) {
        let forward = self.state.navigator.pose.forward;
        // Not from below, and not flat.
        let level = forward.truncate().normalize_or(glam::DVec2::Y);
        let direction = level.extend(forward.z.clamp(-0.95, -0.4)).normalize();
        let away = (EXTENTS_AWAY * extent_m).max(MIN_AWAY_M);
        self.stop();
        let to = Pose::looking_at(target - away * direction, target);
        self.glide = Some(Glide::new(self.state.navigator.pose, to));
        self.moved();
    }

    /// Goes to a coordinate, or lists the buildings of which an attribute holds the text.
    fn find(&mut self, text: &str) {
        self.interface.found.clear();
        let place = self.places.as_ref().and_then(|places| places.parse(text));
        if let Some(point) =
            place.filter(|point| self.city.manifest().grid.bounds().distance_to(*point) == 0.0)
        {
            let ground = self.renderer.resident.ground_at(point).unwrap_or(0.0);
            self.fly_to(point.extend(ground), 0.0);
            self.interface.measure.points = vec![point.extend(ground)];
            return;
        }
        let found = self
            .city
            .footprint_dataset()
            .and_then(|dataset| Ok(dataset.find(text, MAX_FOUND)?));
        match found {
            Ok(found) if found.is_empty() => {
                self.tell(format!("no place of the city and no attribute holds '{text}'"))
            }
            Ok(found) => {
                let first = found[0].0;
                let is_only = found.len() == 1;
                self.interface.found = found;
                if is_only {
                    self.select(Some(first));
                    self.fly_to_selection();
                }
            }
            Err(error) => self.tell(error.to_string()),
        }
    }

    /// Puts the tool or the selection down; false when there was none.
    pub(super) fn put_down(&mut self) -> bool {
        let interface = &mut self.interface;
        let has_tool = interface.tool != Tool::Look || !interface.draft.points.is_empty();
        let had_any = has_tool || interface.selection.is_some() || interface.shows_help;
        if has_tool {
            interface.tool = Tool::Look;
            interface.draft.points.clear();
            interface.measure.points.clear();
        } else {
            interface.selection = None;
        }
        interface.shows_help = false;
        self.pointer.grab = None;
        had_any
    }

    /// The first free file name of the image folder; none when there are too many.
    fn free_name(&self, ending: &str) -> Option<std::path::PathBuf> {
        let city = &self.city.manifest().name;
        (1..10_000)
            .map(|k| self.image_folder.join(format!("{city}-{k:03}.{ending}")))
            .find(|path| !path.exists())
    }

    fn is_full(&self) -> String {
        format!("{}: is full of files of this city", self.image_folder.display())
    }

    /// Writes the image as it is, with depth and ids beside it; what to say of it.
    pub(super) fn save_image(&self) -> Result<String, ViewerError> {
        let Some(image) = self.renderer.image() else {
            return Ok(String::new());
        };
        let rgba = read_texture(&self.renderer.gpu, &image.texture).map_err(RenderError::from)?;
        let (depth, ids) = self.renderer.read_surfaces()?;
        let Some(path) = self.free_name("png") else {
            return Ok(self.is_full());
        };
        let size = self.renderer.size();
        let written = write_png(&path, size, &rgba)
            .and_then(|()| write_depth(&path.with_extension("depth.tif"), size, &depth))
            .and_then(|()| write_ids(&path.with_extension("ids.tif"), size, &ids));
        Ok(match written {
            Ok(()) => format!("saved {}", path.display()),
            Err(error) => error.to_string(),
        })
    }

    /// Writes the flight; what to say of it.
    fn save_flight(&self) -> String {
        let path = &self.interface.recorder.path;
        if path.keys.is_empty() {
            return "the flight has no keys yet".to_owned();
        }
        let Some(file) = self.free_name("flight.json") else {
            return self.is_full();
        };
        match path.write(&file) {
            Ok(()) => format!("saved {}", file.display()),
            Err(error) => error.to_string(),
        }
    }
}
