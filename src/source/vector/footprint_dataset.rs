//! `buildings.gpkg`, the footprint dataset of record: every footprint with its attributes, to be edited in QGIS.

use std::path::{Path, PathBuf};

use gdal::vector::{Defn, Feature, Geometry, LayerAccess, LayerOptions, OGRFieldType, OGRwkbGeometryType};
use gdal::{Dataset, DriverManager};
use geo::MultiPolygon;

use super::FootprintSource;
use super::feature::wkb_of;
use crate::source::{Footprint, HeightRule, SourceError, gdal_failure, gdal_reference, gdal_says};
use crate::space::Crs;

/// Name of the one layer.
pub const LAYER: &str = "buildings";

/// Most attributes of a footprint dataset: SQLite has 2000 columns, some of which are the dataset's own.
const MAX_FIELDS: usize = 1980;

/// Reads a city's footprint dataset.
pub struct FootprintDataset;

impl FootprintDataset {
    /// All footprints of `buildings.gpkg`, by the city's height rule.
    pub fn read(
        path: &Path,
        city: &Crs,
        rule: &HeightRule,
        default_height_m: f64,
    ) -> Result<Vec<Footprint>, SourceError> {
        let mut footprints = Vec::new();
        FootprintSource::open_footprint_dataset(path, None)?.read(
            city,
            rule,
            default_height_m,
            |footprint| {
                footprints.push(footprint);
            },
        )?;
        Ok(footprints)
    }
}

/// Writes a new GeoPackage with the layer `buildings`.
pub struct FootprintDatasetWriter {
    path: PathBuf,
    dataset: Dataset,
    /// Source field index to target field index, -1 where it has no place.
    field_map: Vec<i32>,
}

impl FootprintDatasetWriter {
    /// Creates the file, replacing an older one.
    pub fn create(path: &Path, crs: &Crs) -> Result<Self, SourceError> {
        let write_error = |why: String| SourceError::Write {
            path: path.to_owned(),
            why,
        };
        fix_dataset_date().map_err(write_error)?;
        // A journal that a killed import left would be played into the new file.
        for old in [path.to_owned(), path.with_extension("gpkg-journal")] {
            if old.exists() {
                std::fs::remove_file(old).map_err(|error| write_error(error.to_string()))?;
            }
        }
        let create = || -> Result<Dataset, gdal::errors::GdalError> {
            let driver = DriverManager::get_driver_by_name("GPKG")?;
            let mut dataset = driver.create_vector_only(path)?;
            let srs = gdal_reference(crs).ok();
            dataset.create_layer(LayerOptions {
                name: LAYER,
                srs: srs.as_ref(),
                ty: OGRwkbGeometryType::wkbMultiPolygon,
                options: Some(&["GEOMETRY_NAME=geom", "FID=fid"]),
            })?;
            Ok(dataset)
        };
        // The new file lies in a folder that is made durable, or thrown away, as a whole: SQLite need not do so at each step.
        let options = ["OGR_SQLITE_SYNCHRONOUS", "OGR_SQLITE_JOURNAL"];
        for option in options {
            gdal::config::set_thread_local_config_option(option, "OFF")
                .map_err(|error| write_error(gdal_says(&error)))?;
        }
        let dataset = create();
        for option in options {
            gdal::config::clear_thread_local_config_option(option)
                .map_err(|error| write_error(gdal_says(&error)))?;
        }
        let dataset = dataset.map_err(|error| write_error(gdal_says(&error)))?;
        // SAFETY: the dataset is open; a driver without transactions only returns an error.
        unsafe { gdal_sys::GDALDatasetStartTransaction(dataset.c_dataset(), 0) };
        Ok(Self {
            path: path.to_owned(),
            dataset,
            field_map: Vec::new(),
        })
    }

    fn error(&self, error: gdal::errors::GdalError) -> SourceError {
        SourceError::Write {
            path: self.path.clone(),
            why: gdal_says(&error),
        }
    }

    /// Gives the map the source's attribute columns.
    pub fn copy_fields(&mut self, source: &Defn) -> Result<(), SourceError> {
        let layer = self.dataset.layer(0).map_err(|error| self.error(error))?;
        let mut target_index = 0;
        // SQLite tells columns apart by more than their case.
        let mut names: std::collections::HashSet<String> = ["fid", "geom"].map(str::to_owned).into();
        for field in source.fields() {
            let kind = match field.field_type() {
                known @ (OGRFieldType::OFTInteger
                | OGRFieldType::OFTInteger64
                | OGRFieldType::OFTReal
                | OGRFieldType::OFTDate
                | OGRFieldType::OFTDateTime) => known,
                _ => OGRFieldType::OFTString,
            };
            let name = field_name(&field.name(), &names);
            names.insert(name.to_lowercase());
            let added = gdal::vector::FieldDefn::new(&name, kind)
                .and_then(|definition| definition.add_to_layer(&layer));
            self.field_map.push(if added.is_ok() { target_index } else { -1 });
            target_index += i32::from(added.is_ok());
        }
        Ok(())
    }

    /// Adds one building with the attributes of its source feature.
    pub fn add(
        &mut self,
        source: &Feature<'_>,
        fid: u32,
        outline: &MultiPolygon<f64>,
    ) -> Result<(), SourceError> {
        self.insert(&[(source, &self.field_map)], fid, outline)
    }

    /// Adds one building with the attributes of `known`, a feature of the dataset whose fields were copied, if there is one, and over
    /// them those that `changed` says: `columns` has their places.
    pub fn add_merged(
        &mut self,
        (known, changed): (Option<&Feature<'_>>, &Feature<'_>),
        columns: &[i32],
        fid: u32,
        outline: &MultiPolygon<f64>,
    ) -> Result<(), SourceError> {
        let said: Vec<i32> = (0..)
            .zip(columns)
            .map(|(field, &column)| {
                // SAFETY: the feature is alive and has one field a column.
                let is_said =
                    unsafe { gdal_sys::OGR_F_IsFieldSetAndNotNull(changed.c_feature(), field) != 0 };
                if is_said { column } else { -1 }
            })
            .collect();
        let known = known.map(|known| (known, self.field_map.as_slice()));
        let sources: Vec<_> = known.into_iter().chain([(changed, said.as_slice())]).collect();
        self.insert(&sources, fid, outline)
    }

    /// Adds one building with the attributes of some features, each over those before; beside each where its fields go, -1 for
    /// nowhere.
    fn insert(
        &self,
        sources: &[(&Feature<'_>, &[i32])],
        fid: u32,
        outline: &MultiPolygon<f64>,
    ) -> Result<(), SourceError> {
        let layer = self.dataset.layer(0).map_err(|error| self.error(error))?;
        let geometry = Geometry::from_wkb(&wkb_of(outline)).map_err(|error| self.error(error))?;
        let mut feature = Feature::new(layer.defn()).map_err(|error| self.error(error))?;
        // SAFETY: all features are alive and each map has one entry per field of its feature.
        unsafe {
            for (source, columns) in sources {
                gdal_sys::OGR_F_SetFromWithMap(
                    feature.c_feature(),
                    source.c_feature(),
                    1,
                    columns.as_ptr().cast_mut(),
                );
            }
            gdal_sys::OGR_F_SetFID(feature.c_feature(), i64::from(fid));
        }
        feature
            .set_geometry(geometry)
            .and_then(|()| feature.create(&layer))
            .map_err(|error| self.error(error))
    }

    /// Commits and closes.
    pub fn finish(self) -> Result<(), SourceError> {
        commit(self.path, self.dataset)
    }
}

/// The GeoPackage stores when it was last changed; the same input must give the same bytes.
pub(super) fn fix_dataset_date() -> Result<(), String> {
    gdal::config::set_config_option("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z")
        .map_err(|error| gdal_says(&error))
}

/// Commits a dataset's transaction and closes it.
pub(super) fn commit(path: PathBuf, dataset: Dataset) -> Result<(), SourceError> {
    // SAFETY: the dataset is open.
    let status = unsafe { gdal_sys::GDALDatasetCommitTransaction(dataset.c_dataset()) };
    let closed = dataset.close();
    if status != gdal_sys::OGRErr::OGRERR_NONE {
        let why = gdal_failure().unwrap_or_else(|| "the transaction was refused".to_owned());
        return Err(SourceError::Write { path, why });
    }
    closed.map_err(|error| SourceError::Write {
        path,
        why: gdal_says(&error),
    })
}

/// A column's name that no other has, whatever its case: the field's own, or with a prefix or a number.
fn field_name(field: &str, taken: &std::collections::HashSet<String>) -> String {
    let is_free = |name: &str| !taken.contains(&name.to_lowercase());
    if is_free(field) {
        return field.to_owned();
    }
    let prefixed = format!("source_{field}");
    let reserved = ["fid", "geom"].contains(&field.to_lowercase().as_str());
    if reserved && is_free(&prefixed) {
        return prefixed;
    }
    let numbered = (2..).map(|number| format!("{field}_{number}"));
    numbered
        .into_iter()
        .find(|name| is_free(name))
        .unwrap_or(prefixed)
}

/// Refuses more attributes than a footprint dataset has room for.
pub(super) fn require_few_fields(path: &Path, count: usize) -> Result<(), SourceError> {
    if count <= MAX_FIELDS {
        return Ok(());
    }
    Err(SourceError::Unfit {
        path: path.to_owned(),
        what: format!("has {count} attributes, more than the {MAX_FIELDS} that a GeoPackage holds"),
        advice: "leave some out, with ogr2ogr -select".to_owned(),
    })
}
