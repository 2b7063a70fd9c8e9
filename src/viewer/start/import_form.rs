//! The form of an import: the files that were dropped, what was found in them, and where the city goes.

use std::path::{Path, PathBuf};

use crate::city::ImportOptions;
use crate::source::{SourceError, SurveyFile, SurveyKind, identify};

/// What is filled in.
#[derive(Default)]
pub struct ImportForm {
    files: Vec<SurveyFile>,
    /// The city folder to make.
    out: String,
    /// The city's CRS; empty lets the terrain decide.
    crs: String,
}

impl ImportForm {
    /// Whether no file was dropped yet.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Takes a file, or those of a folder.
    ///
    /// # Errors
    /// When it is no survey file.
    pub fn add(&mut self, path: &Path) -> Result<(), SourceError> {
        let file = identify(path)?;
        if self.files.iter().all(|known| known.path != file.path) {
            self.files.push(file);
        }
        if self.out.is_empty()
            && let Some(folder) = path.parent()
        {
            self.out = folder.join("city").display().to_string();
        }
        Ok(())
    }

    /// The import that it asks for.
    ///
    /// # Errors
    /// What is missing.
    pub fn options(&self) -> Result<ImportOptions, String> {
        let of = |kind: SurveyKind| -> Vec<PathBuf> {
            let files = self.files.iter().filter(|file| file.kind == kind);
            files.map(|file| file.path.clone()).collect()
        };
        let (terrain, buildings) = (of(SurveyKind::Terrain), of(SurveyKind::Footprints));
        if terrain.is_empty() {
            return Err("drop a terrain raster as well".to_owned());
        }
        let [buildings] = <[PathBuf; 1]>::try_from(buildings)
            .map_err(|files| format!("{} files of buildings; one is wanted", files.len()))?;
        if self.out.trim().is_empty() {
            return Err("name the folder of the city".to_owned());
        }
        let crs = Some(self.crs.trim().to_owned()).filter(|crs| !crs.is_empty());
        Ok(ImportOptions {
            imagery: of(SurveyKind::Imagery),
            crs,
            ..ImportOptions::new(terrain, buildings, PathBuf::from(self.out.trim()))
        })
    }

    /// Lays it out; true when the import is wanted.
    pub fn show(&mut self, ui: &mut egui::Ui) -> bool {
        ui.strong("Import survey files");
        let mut removed = None;
        egui::ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            for (index, file) in self.files.iter_mut().enumerate() {
                ui.separator();
                ui.horizontal(|ui| {
                    let name = file
                        .path
                        .file_name()
                        .unwrap_or_default()
                        .to_string_lossy()
                        .into_owned();
                    ui.label(name).on_hover_text(file.path.display().to_string());
                    egui::ComboBox::from_id_salt(index)
                        .selected_text(name_of(file.kind))
                        .show_ui(ui, |ui| {
                            for (kind, name) in SurveyKind::ALL {
                                ui.selectable_value(&mut file.kind, kind, name);
                            }
                        });
                    if ui.small_button("×").clicked() {
                        removed = Some(index);
                    }
                });
                let crs = file
                    .crs
                    .as_deref()
                    .unwrap_or("names no CRS: it is taken to be in the city's");
                ui.small(crs);
                for line in &file.holds {
                    ui.add(egui::Label::new(egui::RichText::new(line).small()).wrap());
                }
            }
        });
        if let Some(index) = removed {
            self.files.remove(index);
        }
        ui.separator();
        egui::Grid::new("import").num_columns(2).show(ui, |ui| {
            ui.label("city folder");
            ui.add(egui::TextEdit::singleline(&mut self.out).desired_width(420.0));
            ui.end_row();
            ui.label("CRS");
            ui.add(
                egui::TextEdit::singleline(&mut self.crs)
                    .hint_text("EPSG:n, or empty: the terrain's")
                    .desired_width(420.0),
            );
            ui.end_row();
        });
        ui.horizontal(|ui| {
            let missing = self.options().err();
            let button = ui.add_enabled(missing.is_none(), egui::Button::new("Import"));
            if let Some(why) = missing {
                ui.small(why);
            }
            button.clicked()
        })
        .inner
    }
}

fn name_of(kind: SurveyKind) -> &'static str {
    let found = SurveyKind::ALL.iter().find(|(known, _)| *known == kind);
    found.map_or("", |(_, name)| name)
}
