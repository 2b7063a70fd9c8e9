//! Single footprints of a dataset by their ids: attributes, a search among them, and copies with changes.

use std::path::Path;

use gdal::vector::{Feature, LayerAccess, OGRFieldType};
use geo::MultiPolygon;

use super::FootprintSource;
use super::feature::column_text;
use super::footprint_dataset::FootprintDatasetWriter;
use crate::source::{SourceError, gdal_says};

/// What a copy of a footprint has that the footprint has not.
#[derive(Clone, Debug, Default)]
pub struct FootprintChange {
    /// Its outline, in the dataset's CRS.
    pub outline: Option<MultiPolygon<f64>>,
    /// A number, and the attribute that it goes into.
    pub value: Option<(String, f64)>,
}

impl FootprintSource {
    /// Names and values of a footprint's attributes that have one; none without the footprint.
    ///
    /// # Errors
    /// When the dataset cannot be read.
    pub fn attributes(&self, fid: u32) -> Result<Option<Vec<(String, String)>>, SourceError> {
        let layer = self.layer()?;
        let Some(feature) = layer.feature(u64::from(fid)) else {
            return Ok(None);
        };
        let fields = layer.defn().fields().enumerate();
        let text = |(index, field): (usize, gdal::vector::Field<'_>)| {
            Some((field.name(), column_text(&feature, index)?))
        };
        Ok(Some(fields.filter_map(text).collect()))
    }

    /// Ids of footprints of which some attribute holds `text`, whatever the case; at most `limit`, with the attribute's value.
    ///
    /// # Errors
    /// When the dataset cannot be read.
    pub fn find(&self, text: &str, limit: usize) -> Result<Vec<(u32, String)>, SourceError> {
        let mut layer = self.layer()?;
        let names: Vec<String> = layer.defn().fields().map(|field| field.name()).collect();
        if names.is_empty() || text.trim().is_empty() {
            return Ok(Vec::new());
        }
        let mut pattern = String::new();
        for letter in text.trim().chars() {
            match letter {
                '\'' => pattern.push_str("''"),
                '%' | '_' | '\\' => pattern.extend(['\\', letter]),
                letter => pattern.push(letter),
            }
        }
        let holds = |name: &String| {
            format!(
                "CAST(\"{}\" AS TEXT) LIKE '%{pattern}%' ESCAPE '\\'",
                name.replace('"', "\"\"")
            )
        };
        let filter = names.iter().map(holds).collect::<Vec<_>>().join(" OR ");
        layer
            .set_attribute_filter(&filter)
            .map_err(|error| self.read_error(gdal_says(&error)))?;
        let wanted = text.trim().to_lowercase();
        let found = layer.features().take(limit).filter_map(|feature| {
            let fid = u32::try_from(feature.fid()?).ok()?;
            let texts = (0..names.len()).filter_map(|index| column_text(&feature, index));
            let said = texts
                .into_iter()
                .find(|text| text.to_lowercase().contains(&wanted));
            Some((fid, said.unwrap_or_default()))
        });
        Ok(found.collect())
    }

    /// The largest id; 0 without any.
    ///
    /// # Errors
    /// When the dataset cannot be read.
    pub fn max_fid(&self) -> Result<u32, SourceError> {
        let query = format!(
            "SELECT MAX(fid) FROM \"{}\"",
            self.layer()?.name().replace('"', "\"\"")
        );
        let mut result = self
            .dataset
            .execute_sql(query, None, gdal::vector::sql::Dialect::DEFAULT)
            .map_err(|error| self.read_error(gdal_says(&error)))?;
        let row = result.as_mut().and_then(|rows| rows.features().next());
        let last = row.and_then(|row| row.field_as_integer64(0).ok().flatten());
        Ok(last.and_then(|last| u32::try_from(last).ok()).unwrap_or(0))
    }

    /// Ids of the footprints that differ from those of `known`, an older copy of the same dataset, in outline or in an attribute, or are
    /// not in it; and of those that only it has. By SQLite, on the primary keys; as sums, because OGR takes a bare key for the rows' own.
    ///
    /// # Errors
    /// When a file cannot be read, or they are not copies of one dataset.
    pub fn differing(&self, known: &Path) -> Result<[Vec<u32>; 2], SourceError> {
        let run = |query: String| -> Result<Vec<u32>, SourceError> {
            let result = self
                .dataset
                .execute_sql(query, None, gdal::vector::sql::Dialect::DEFAULT)
                .map_err(|error| self.read_error(gdal_says(&error)))?;
            let Some(mut rows) = result else {
                return Ok(Vec::new());
            };
            let ids = rows.features().map(|row| row.field_as_integer64(0));
            Ok(ids.filter_map(|id| u32::try_from(id.ok()??).ok()).collect())
        };
        let quoted = |name: &str| format!("\"{}\"", name.replace('"', "\"\""));
        let layer = self.layer()?;
        let table = quoted(&layer.name());
        // SAFETY: the layer is alive, and its text is copied at once.
        let geometry =
            unsafe { std::ffi::CStr::from_ptr(gdal_sys::OGR_L_GetGeometryColumn(layer.c_layer())) };
        let geometry = geometry.to_string_lossy().into_owned();
        let columns = layer.defn().fields().map(|field| field.name()).chain([geometry]);
        let differs: Vec<String> = columns
            .map(|name| format!("n.{0} IS NOT k.{0}", quoted(&name)))
            .collect();
        run(format!(
            "ATTACH DATABASE '{}' AS known",
            known.display().to_string().replace('\'', "''")
        ))?;
        let changed = run(format!(
            "SELECT n.fid + 0 AS id FROM main.{table} n LEFT JOIN known.{table} k ON k.fid = n.fid WHERE k.fid IS NULL OR {}",
            differs.join(" OR ")
        ));
        let removed = run(format!(
            "SELECT k.fid + 0 AS id FROM known.{table} k LEFT JOIN main.{table} n ON n.fid = k.fid WHERE n.fid IS NULL"
        ));
        run("DETACH DATABASE known".to_owned())?;
        Ok([changed?, removed?])
    }

    /// The layer's name, and how many features it has.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn layer_size(&self) -> Result<(String, u64), SourceError> {
        let layer = self.layer()?;
        Ok((layer.name(), layer.feature_count()))
    }

    /// Whether the file itself names the CRS of its coordinates.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn names_crs(&self) -> Result<bool, SourceError> {
        Ok(self.is_cityjson || self.layer()?.spatial_ref().is_some())
    }

    /// Whether there is an attribute of a name.
    ///
    /// # Errors
    /// When the dataset cannot be read.
    pub fn has_field(&self, name: &str) -> Result<bool, SourceError> {
        Ok(self.layer()?.defn().field_index(name).is_ok())
    }

    /// Writes a footprint with a change to a new dataset with the same attributes; one that is not there yet is made of the change alone.
    ///
    /// # Errors
    /// When a dataset cannot be read or written, or nothing gives the outline.
    pub fn write_changed(
        &self,
        fid: u32,
        outline: &MultiPolygon<f64>,
        change: &FootprintChange,
        writer: &mut FootprintDatasetWriter,
    ) -> Result<(), SourceError> {
        let layer = self.layer()?;
        writer.copy_fields(layer.defn())?;
        let failed = |error| self.read_error(gdal_says(&error));
        let mut feature = match layer.feature(u64::from(fid)) {
            Some(feature) => feature,
            None => Feature::new(layer.defn()).map_err(failed)?,
        };
        if let Some((name, value)) = &change.value {
            let column = layer.defn().field_index(name).map_err(failed)?;
            let kind = layer.defn().fields().nth(column).map(|field| field.field_type());
            let set = match kind {
                Some(OGRFieldType::OFTInteger | OGRFieldType::OFTInteger64) => {
                    feature.set_field_integer64(column, value.round() as i64)
                }
                Some(OGRFieldType::OFTString) => feature.set_field_string(column, &value.to_string()),
                _ => feature.set_field_double(column, *value),
            };
            set.map_err(failed)?;
        }
        writer.add(&feature, fid, change.outline.as_ref().unwrap_or(outline))
    }
}
