//! Changes single footprints of `buildings.gpkg`, in one transaction.

use std::path::{Path, PathBuf};

use gdal::vector::{Defn, Feature, LayerAccess};
use gdal::{Dataset, DatasetOptions, GdalOpenFlags};

use super::FootprintSource;
use super::footprint_dataset::{LAYER, fix_dataset_date};
use super::plain_geopackage::require_plain;
use crate::source::{SourceError, gdal_failure, gdal_says};

/// An open footprint dataset.
pub struct FootprintDatasetEditor {
    path: PathBuf,
    dataset: Dataset,
}

impl FootprintDatasetEditor {
    /// Opens a dataset and begins a transaction.
    ///
    /// # Errors
    /// When it cannot be opened for writing.
    pub fn open(path: &Path) -> Result<Self, SourceError> {
        fix_dataset_date().map_err(|why| write_error(path, why))?;
        let options = DatasetOptions {
            open_flags: GdalOpenFlags::GDAL_OF_VECTOR
                | GdalOpenFlags::GDAL_OF_UPDATE
                | GdalOpenFlags::GDAL_OF_VERBOSE_ERROR,
            allowed_drivers: Some(&["GPKG"]),
            ..DatasetOptions::default()
        };
        require_plain(path)?;
        let dataset =
            Dataset::open_ex(path, options).map_err(|error| write_error(path, gdal_says(&error)))?;
        // SAFETY: the dataset is open.
        let status = unsafe { gdal_sys::GDALDatasetStartTransaction(dataset.c_dataset(), 0) };
        if status != gdal_sys::OGRErr::OGRERR_NONE {
            return Err(write_error(path, "no transaction could be begun".to_owned()));
        }
        let editor = Self {
            path: path.to_owned(),
            dataset,
        };
        // The first read of a transaction keeps others from writing until its end.
        editor.layer()?.feature(0);
        Ok(editor)
    }

    /// Puts every feature of another dataset in, over the one of the same id where there is one: its geometry, and those of its
    /// attributes that have a column. Doing it twice is doing it once.
    ///
    /// # Errors
    /// When a file cannot be read or written.
    pub fn put_all(&mut self, changes: &FootprintSource) -> Result<(), SourceError> {
        let layer = self.layer()?;
        let mut source = changes.layer()?;
        let columns = columns_of(source.defn(), layer.defn());
        for changed in source.features() {
            let Some(fid) = changed.fid() else { continue };
            let known = layer.feature(fid);
            let is_known = known.is_some();
            let mut feature = match known {
                Some(feature) => feature,
                None => Feature::new(layer.defn()).map_err(|error| self.error(error))?,
            };
            // SAFETY: both features are alive and there is one column a field of the changed one.
            unsafe {
                gdal_sys::OGR_F_SetFromWithMap(
                    feature.c_feature(),
                    changed.c_feature(),
                    1,
                    columns.as_ptr().cast_mut(),
                );
                gdal_sys::OGR_F_SetFID(feature.c_feature(), fid as i64);
                if !is_known {
                    // What is not said gets the column's default.
                    for field in 0..gdal_sys::OGR_F_GetFieldCount(feature.c_feature()) {
                        if gdal_sys::OGR_F_IsFieldNull(feature.c_feature(), field) != 0 {
                            gdal_sys::OGR_F_UnsetField(feature.c_feature(), field);
                        }
                    }
                }
            }
            if let Some(geometry) = changed.geometry() {
                feature
                    .set_geometry(geometry.clone())
                    .map_err(|error| self.error(error))?;
            }
            // SAFETY: the layer is open for writing and the feature is of it.
            let status = unsafe {
                if is_known {
                    gdal_sys::OGR_L_SetFeature(layer.c_layer(), feature.c_feature())
                } else {
                    gdal_sys::OGR_L_CreateFeature(layer.c_layer(), feature.c_feature())
                }
            };
            if status != gdal_sys::OGRErr::OGRERR_NONE {
                return Err(self.refused(&format!("building {fid} could not be written")));
            }
        }
        Ok(())
    }

    /// Takes features out; those that are not there are none the less gone.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn remove(&mut self, fids: &[u32]) -> Result<(), SourceError> {
        let layer = self.layer()?;
        for &fid in fids {
            if layer.feature(u64::from(fid)).is_some() {
                // SAFETY: the layer is open for writing.
                let status = unsafe { gdal_sys::OGR_L_DeleteFeature(layer.c_layer(), i64::from(fid)) };
                if status != gdal_sys::OGRErr::OGRERR_NONE {
                    return Err(self.refused(&format!("feature {fid} could not be removed")));
                }
            }
        }
        Ok(())
    }

    /// Commits and closes.
    ///
    /// # Errors
    /// When the transaction is refused.
    pub fn finish(self) -> Result<(), SourceError> {
        super::footprint_dataset::commit(self.path, self.dataset)
    }

    fn layer(&self) -> Result<gdal::vector::Layer<'_>, SourceError> {
        self.dataset
            .layer_by_name(LAYER)
            .map_err(|error| self.error(error))
    }

    fn error(&self, error: gdal::errors::GdalError) -> SourceError {
        write_error(&self.path, gdal_says(&error))
    }

    /// Without a reason from GDAL `what` alone.
    fn refused(&self, what: &str) -> SourceError {
        write_error(&self.path, gdal_failure().unwrap_or_else(|| what.to_owned()))
    }
}

fn write_error(path: &Path, why: String) -> SourceError {
    SourceError::Write {
        path: path.to_owned(),
        why,
    }
}

/// For each field of `source` the field of `target` with its name, -1 without one.
pub(super) fn columns_of(source: &Defn, target: &Defn) -> Vec<i32> {
    let fields = source.fields();
    fields
        .map(|field| {
            let index = target.field_index(field.name());
            index
                .ok()
                .and_then(|index| i32::try_from(index).ok())
                .unwrap_or(-1)
        })
        .collect()
}
