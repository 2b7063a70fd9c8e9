//! Edits of single buildings, each an update of its own, with undo and redo.
//!
//! A step keeps the footprint before and after it as datasets of their own, with all attributes: going back or forward is putting one
//! of them into the city, by the update that everybody uses. What is done is on disk: a program that stops loses at most the edit
//! in hand.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use geo::{MultiPolygon, Validation};

use super::update::{UpdateOptions, UpdateReport, update};
use super::{City, CityError};
use crate::source::{FootprintChange, FootprintDatasetWriter, FootprintSource, HeightReading, HeightRule};
use crate::space::Crs;

/// Largest dataset of which a copy is kept, bytes: of a larger one all footprints are compared.
const MAX_KNOWN_BYTES: u64 = 1 << 30;

/// An edit of one building.
#[derive(Clone, Debug)]
pub enum Edit {
    /// A new building.
    Add {
        /// Its outline, metres in the city's CRS.
        outline: MultiPolygon<f64>,
        /// Height above its base, metres.
        height_m: f64,
    },
    /// Another outline.
    Outline {
        /// The building.
        fid: u32,
        /// The outline.
        outline: MultiPolygon<f64>,
    },
    /// Another height.
    Height {
        /// The building.
        fid: u32,
        /// Height above its base, metres.
        height_m: f64,
    },
    /// No building any more.
    Delete {
        /// The building.
        fid: u32,
    },
}

/// What a building is on one side of a step.
#[derive(Clone, Debug)]
enum State {
    /// The footprint of a dataset.
    Standing(PathBuf),
    Absent,
}

/// One step: a building before and after it.
#[derive(Clone, Debug)]
struct Step {
    fid: u32,
    before: State,
    after: State,
}

/// What an edit did.
#[derive(Clone, Debug)]
pub struct EditReport {
    /// The building.
    pub fid: u32,
    /// Whether it stands now.
    pub is_standing: bool,
    /// The update.
    pub update: UpdateReport,
}

/// Edits of a city, in their order.
pub struct Editor {
    city: PathBuf,
    /// Datasets of the steps.
    scratch: PathBuf,
    serial: u64,
    done: Vec<Step>,
    undone: Vec<Step>,
    /// A copy of the footprint dataset as the tiles of a generation show it.
    known: Option<(u64, PathBuf)>,
}

impl Editor {
    /// For a city; `scratch`: a folder of its own, made when needed and removed at the end.
    pub fn new(city: &Path, scratch: PathBuf) -> Self {
        Self {
            city: city.to_owned(),
            scratch,
            serial: 0,
            done: Vec::new(),
            undone: Vec::new(),
            known: None,
        }
    }

    /// Steps that can be undone and redone.
    pub fn depth(&self) -> [usize; 2] {
        [self.done.len(), self.undone.len()]
    }

    /// Makes an edit.
    ///
    /// # Errors
    /// When it cannot be: the city is as before.
    pub fn apply(&mut self, edit: &Edit) -> Result<EditReport, CityError> {
        let step = self.step(edit)?;
        let report = self.go(&step, true)?;
        self.done.push(step);
        self.undone.clear();
        Ok(report)
    }

    /// Takes the last edit back; none when there is none.
    ///
    /// # Errors
    /// When it cannot be: the city is as before.
    pub fn undo(&mut self) -> Result<Option<EditReport>, CityError> {
        let Some(step) = self.done.last().cloned() else {
            return Ok(None);
        };
        let report = self.go(&step, false)?;
        self.undone.extend(self.done.pop());
        Ok(Some(report))
    }

    /// Makes the edit again that was taken back last; none when there is none.
    ///
    /// # Errors
    /// When it cannot be: the city is as before.
    pub fn redo(&mut self) -> Result<Option<EditReport>, CityError> {
        let Some(step) = self.undone.last().cloned() else {
            return Ok(None);
        };
        let report = self.go(&step, true)?;
        self.done.extend(self.undone.pop());
        Ok(Some(report))
    }

    /// Takes over what others edited in the footprint dataset.
    ///
    /// # Errors
    /// When it cannot be read: the city is as before.
    pub fn take_over(&mut self) -> Result<UpdateReport, CityError> {
        let generation = City::open(&self.city)?.manifest().generation;
        let known = self.known.as_ref().filter(|(of, _)| *of == generation);
        update(&UpdateOptions {
            city: self.city.clone(),
            buildings: None,
            layer: None,
            crs: None,
            delete: Vec::new(),
            known: known.map(|(_, path)| path.clone()),
            replaces_attributes: true,
        })
    }

    /// Keeps a copy of the footprint dataset while the tiles show it: what others edit in it is found by it at once. Cheap when there
    /// is one of this state already. Whether one was made.
    ///
    /// # Errors
    /// When the copy cannot be made: all footprints are compared then.
    pub fn keep_known(&mut self) -> Result<bool, CityError> {
        let city = City::open(&self.city)?;
        let generation = city.manifest().generation;
        let is_kept = self.known.as_ref().is_some_and(|(of, _)| *of == generation);
        if is_kept || city.edited_dataset().is_some() {
            return Ok(false);
        }
        self.known = None;
        let dataset = city.footprint_dataset_path();
        if fs::metadata(&dataset).map_or(u64::MAX, |data| data.len()) > MAX_KNOWN_BYTES {
            return Ok(false);
        }
        fs::create_dir_all(&self.scratch).map_err(CityError::file(&self.scratch))?;
        let path = self.scratch.join("known.gpkg");
        fs::copy(&dataset, &path).map_err(CityError::file(&path))?;
        // Unless it was edited meanwhile.
        if City::open(&self.city)?.manifest().generation == generation && city.edited_dataset().is_none() {
            self.known = Some((generation, path));
        }
        Ok(true)
    }

    /// The datasets of an edit.
    fn step(&mut self, edit: &Edit) -> Result<Step, CityError> {
        let city = City::open(&self.city)?;
        let dataset = city.footprint_dataset()?;
        let crs = Crs::from_text(&city.manifest().crs)?;
        fs::create_dir_all(&self.scratch).map_err(CityError::file(&self.scratch))?;
        let rule = &city.manifest().height_rule;
        let standing = |fid: u32| {
            let missing = || CityError::NoBuilding {
                path: city.footprint_dataset_path(),
                fid,
            };
            city.building(fid)?
                .map(|details| details.building)
                .ok_or_else(missing)
        };
        let (fid, before, change) = match edit {
            Edit::Add { outline, height_m } => {
                let fid = dataset.max_fid()?.saturating_add(1);
                require_simple(fid, outline)?;
                let base = city.base_under(outline)?;
                let value = height_value(&dataset, rule, *height_m, base)?;
                let change = FootprintChange {
                    outline: Some(outline.clone()),
                    value,
                };
                (fid, None, Some(change))
            }
            Edit::Outline { fid, outline } => {
                require_simple(*fid, outline)?;
                let change = FootprintChange {
                    outline: Some(outline.clone()),
                    value: None,
                };
                (*fid, Some(standing(*fid)?), Some(change))
            }
            Edit::Height { fid, height_m } => {
                let before = standing(*fid)?;
                let value = height_value(&dataset, rule, *height_m, before.base_m)?;
                if value.is_none() {
                    return Err(CityError::NoHeightField {
                        path: city.footprint_dataset_path(),
                    });
                }
                (*fid, Some(before), Some(FootprintChange { outline: None, value }))
            }
            Edit::Delete { fid } => (*fid, Some(standing(*fid)?), None),
        };
        let mut write = |change: &FootprintChange| -> Result<State, CityError> {
            self.serial += 1;
            let path = self.scratch.join(format!("{:06}.gpkg", self.serial));
            let mut writer = FootprintDatasetWriter::create(&path, &crs)?;
            let known = before.as_ref().map(|building| &building.outline);
            let outline = known
                .or(change.outline.as_ref())
                .cloned()
                .unwrap_or(MultiPolygon::new(Vec::new()));
            dataset.write_changed(fid, &outline, change, &mut writer)?;
            writer.finish()?;
            Ok(State::Standing(path))
        };
        let own = match &before {
            Some(_) => write(&FootprintChange::default())?,
            None => State::Absent,
        };
        let after = match &change {
            Some(change) => write(change)?,
            None => State::Absent,
        };
        Ok(Step {
            fid,
            before: own,
            after,
        })
    }

    /// Brings the building to the side of a step.
    fn go(&self, step: &Step, forward: bool) -> Result<EditReport, CityError> {
        let state = if forward { &step.after } else { &step.before };
        let (buildings, delete) = match state {
            State::Standing(path) => (Some(path.clone()), Vec::new()),
            State::Absent => (None, vec![step.fid]),
        };
        let is_standing = buildings.is_some();
        let update = update(&UpdateOptions {
            city: self.city.clone(),
            buildings,
            layer: None,
            crs: None,
            delete,
            known: None,
            replaces_attributes: true,
        })?;
        // What has no ground, or is no footprint, is not taken; nothing was written then.
        let is_taken = update
            .counts
            .is_none_or(|[added, changed, _]| added + changed > 0);
        if is_standing && !is_taken {
            return Err(CityError::NotTaken { fid: step.fid });
        }
        Ok(EditReport {
            fid: step.fid,
            is_standing,
            update,
        })
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        // What stays is a temporary folder of a few files.
        let _ = fs::remove_dir_all(&self.scratch);
    }
}

/// Refuses outlines that cross themselves: what they enclose is a matter of opinion.
fn require_simple(fid: u32, outline: &MultiPolygon<f64>) -> Result<(), CityError> {
    match outline.0.is_empty() || !outline.is_valid() {
        true => Err(CityError::WrongOutline { fid }),
        false => Ok(()),
    }
}

/// The attribute that a height goes into, and its value there; none when no attribute of the dataset tells heights.
fn height_value(
    dataset: &FootprintSource,
    rule: &HeightRule,
    height_m: f64,
    base_m: f64,
) -> Result<Option<(String, f64)>, CityError> {
    for field in rule.fields() {
        if !dataset.has_field(&field.field)? {
            continue;
        }
        let value = match &field.reading {
            HeightReading::Height { unit_m } => height_m / unit_m,
            HeightReading::RoofElevation => base_m + height_m,
            HeightReading::Storeys {
                storey_height_m,
                plus: None,
            } => (height_m / storey_height_m).round().max(1.0),
            // Told by two attributes: neither alone can be changed for it.
            HeightReading::Storeys { plus: Some(_), .. } | HeightReading::RoofLessGround { .. } => continue,
        };
        return Ok(Some((field.field, value)));
    }
    Ok(None)
}

impl City {
    /// What tells one state of the footprint dataset on disk from another, when it was changed after the tiles were made: times and
    /// lengths of the file and of its log. None when the tiles are of it.
    pub fn edited_dataset(&self) -> Option<[Option<(SystemTime, u64)>; 2]> {
        let path = self.footprint_dataset_path();
        let stamp = |path: &Path| {
            let data = fs::metadata(path).ok()?;
            Some((data.modified().ok()?, data.len()))
        };
        let (made, _) = stamp(&self.folder().join("city.toml"))?;
        let stamps = [
            stamp(&path),
            stamp(&path.with_extension("gpkg-wal")).filter(|(_, bytes)| *bytes > 0),
        ];
        let is_newer = stamps.iter().flatten().any(|(changed, _)| *changed > made);
        is_newer.then_some(stamps)
    }

    /// The lowest ground at an outline's vertices, metres.
    fn base_under(&self, outline: &MultiPolygon<f64>) -> Result<f64, CityError> {
        let ground = self.ground();
        let base = crate::buildings::base_of(outline, |x, y| ground.at(x, y).ok().flatten());
        Ok(base.map_or(0.0, |(base, _)| base))
    }
}
