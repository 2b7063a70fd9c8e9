//! A footprint file opened with OGR, and its layer (`read_footprints` takes the footprints out).

use std::path::{Path, PathBuf};

use gdal::vector::{Defn, LayerAccess, OGRwkbGeometryType};
use gdal::{Dataset, DatasetOptions, GdalOpenFlags};
use glam::DVec2;

use super::cityjson;
use super::cityjson_text::virtual_path;
use super::file_end::require_end;
use super::footprint_dataset::{LAYER, require_few_fields};
use super::plain_geopackage::require_plain;
use crate::source::sound_file::in_zip;
use crate::source::{CrsChoice, SourceError, SourceRole, gdal_reference, gdal_says, require_sound};
use crate::space::{Crs, GeoArea};

/// Where a building's id comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FeatureIds {
    /// The feature's own id, which the format keeps.
    Own,
    /// A column.
    Column(usize),
    /// The feature's place in the source, from 1.
    Index,
}

/// One layer of a vector file.
pub struct FootprintSource {
    pub(super) path: PathBuf,
    pub(super) dataset: Dataset,
    pub(super) layer_index: usize,
    pub(super) crs: Crs,
    pub(super) is_osm: bool,
    /// Lines count as outlines: CAD drawings have no areas.
    pub(super) is_cad: bool,
    /// The chosen layer of a CAD drawing, as a filter of its one OGR layer.
    pub(super) cad_filter: Option<String>,
    pub(super) is_cityjson: bool,
    /// A CityJSON's vertices lie in its own extent only without its translation, which was dropped.
    pub translation_dropped: bool,
    pub(super) ids: FeatureIds,
    /// The driver ends a damaged file like a whole one; its error messages and its own count tell.
    pub(super) reads_past_damage: bool,
}

/// The column of building ids in a footprint dataset.
const FID: &str = "fid";

impl FootprintSource {
    /// Opens a file and picks its layer: the named one, or the only one with areas.
    pub fn open(path: &Path, layer: Option<&str>, choice: &CrsChoice) -> Result<Self, SourceError> {
        Self::open_by(path, layer, choice, None)
    }

    fn open_by(
        path: &Path,
        layer: Option<&str>,
        choice: &CrsChoice,
        drivers: Option<&[&str]>,
    ) -> Result<Self, SourceError> {
        require_sound(path)?;
        let city = virtual_path(path)
            .map(|virtual_path| cityjson::open(path, &virtual_path))
            .transpose()?;
        let is_cityjson = city.is_some();
        let (dataset, cityjson_crs, translation_dropped) = match city {
            Some(city) => (city.dataset, city.crs, city.translation_dropped),
            None => (open_vector(path, drivers)?, None, false),
        };
        let driver = dataset.driver().short_name();
        let (is_osm, is_cad) = (
            driver == "OSM",
            driver == "DXF" || driver == "DGN" || driver == "CAD",
        );
        let mut source = Self {
            path: path.to_owned(),
            dataset,
            layer_index: 0,
            crs: Crs::wgs84().map_err(|source| SourceError::Crs {
                path: path.to_owned(),
                source,
            })?,
            is_osm,
            is_cad,
            cad_filter: None,
            is_cityjson,
            translation_dropped,
            ids: FeatureIds::Index,
            reads_past_damage: ["FlatGeobuf", "ESRI Shapefile", "GPKG"].contains(&driver.as_str()),
        };
        source.pick_layer(layer)?;
        source.require_few_fields()?;
        let own = match cityjson_crs {
            Some(crs) => gdal_reference(&crs).ok(),
            None => source.layer()?.spatial_ref(),
        };
        source.crs = choice.of_file(path, own, SourceRole::Footprints)?;
        if source.has_stable_ids() {
            source.ids = FeatureIds::Own;
        }
        Ok(source)
    }

    /// A footprint dataset has no room for more.
    fn require_few_fields(&self) -> Result<(), SourceError> {
        require_few_fields(&self.path, self.layer()?.defn().fields().count())
    }

    /// Opens a city's footprint dataset of record; `written_in`: the CRS of one that was just written.
    pub fn open_footprint_dataset(path: &Path, written_in: Option<&Crs>) -> Result<Self, SourceError> {
        let is_plain = std::fs::symlink_metadata(path).is_ok_and(|data| data.is_file());
        if !is_plain {
            return Err(SourceError::Open {
                path: path.to_owned(),
                why: "it is no plain file; a city's files lie in its folder".to_owned(),
                expected: "footprint dataset",
            });
        }
        // What was just written here is nobody else's.
        if written_in.is_none() {
            require_plain(path)?;
        }
        let layer = Some(LAYER);
        // Nothing else that lies there under its name: a description could name other files and servers.
        let source = Self::open_by(
            path,
            layer,
            &CrsChoice::new(written_in.cloned(), None),
            Some(&["GPKG"]),
        )?;
        // Its definition is in the file, and an operation from it would open the grids that it names.
        match Crs::is_plain_definition(source.crs.label()) {
            true => Ok(source),
            false => Err(SourceError::Unfit {
                path: path.to_owned(),
                what: "its coordinate reference system names other files".to_owned(),
                advice: "import the city again from its sources".to_owned(),
            }),
        }
    }

    /// Takes building ids from the column `fid` where the format keeps none: for features that are to meet others by their ids.
    ///
    /// # Errors
    /// Without such a column.
    pub fn require_ids(mut self) -> Result<Self, SourceError> {
        if self.ids == FeatureIds::Own {
            return Ok(self);
        }
        let names = self.field_names()?;
        let column = names.iter().position(|name| name.eq_ignore_ascii_case(FID));
        let Some(column) = column else {
            return Err(SourceError::NoIds {
                path: self.path.clone(),
            });
        };
        self.ids = FeatureIds::Column(column);
        Ok(self)
    }

    /// True when the format keeps feature ids through edits, and all of them can be building ids.
    fn has_stable_ids(&self) -> bool {
        let keeps = ["GPKG", "PostgreSQL"].contains(&self.dataset.driver().short_name().as_str());
        let range = || {
            let layer = self.layer().ok()?;
            // SAFETY: the layer is alive, and its text is copied at once.
            let column = unsafe { std::ffi::CStr::from_ptr(gdal_sys::OGR_L_GetFIDColumn(layer.c_layer())) };
            let [column, name] = [column.to_str().ok()?, &layer.name()].map(|name| name.replace('"', "\"\""));
            // Each alone SQLite answers from its index; both at once it would scan the table.
            let query = format!(
                "SELECT (SELECT MIN(\"{column}\") FROM \"{name}\"), (SELECT MAX(\"{column}\") FROM \"{name}\")"
            );
            let mut result = self
                .dataset
                .execute_sql(query, None, gdal::vector::sql::Dialect::DEFAULT);
            let row = result.as_mut().ok()?.as_mut()?.features().next()?;
            Some([row.field_as_integer64(0).ok()??, row.field_as_integer64(1).ok()??])
        };
        keeps && range().is_some_and(|[first, last]| first >= 1 && u32::try_from(last).is_ok())
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The CRS of the file's coordinates.
    pub fn crs(&self) -> &Crs {
        &self.crs
    }

    /// Where on the globe the layer's extent lies; none when OGR does not know it.
    pub fn area_on_globe(&self) -> Option<GeoArea> {
        let extent = self.layer().ok()?.try_get_extent().ok()??;
        let (min, max) = (
            DVec2::new(extent.MinX, extent.MinY),
            DVec2::new(extent.MaxX, extent.MaxY),
        );
        self.crs.area_on_globe(min, max).ok()?
    }

    /// Names of the layer's attributes.
    pub fn field_names(&self) -> Result<Vec<String>, SourceError> {
        let layer = self.layer()?;
        Ok(layer.defn().fields().map(|field| field.name()).collect())
    }

    pub(super) fn layer(&self) -> Result<gdal::vector::Layer<'_>, SourceError> {
        self.dataset
            .layer(self.layer_index)
            .map_err(|error| self.read_error(gdal_says(&error)))
    }

    pub(super) fn read_error(&self, why: String) -> SourceError {
        SourceError::Read {
            path: self.path.clone(),
            why,
        }
    }

    /// Names of the layers, without their definitions: for that of a view its rows are asked, which may have no end.
    fn layer_names(&self) -> Vec<String> {
        // SAFETY: the dataset is open, its layers live as long, and their names are copied at once.
        unsafe {
            let dataset = self.dataset.c_dataset();
            let layers = (0..gdal_sys::GDALDatasetGetLayerCount(dataset))
                .map(|index| gdal_sys::GDALDatasetGetLayer(dataset, index))
                .filter(|layer| !layer.is_null());
            layers
                .map(|layer| {
                    std::ffi::CStr::from_ptr(gdal_sys::OGR_L_GetName(layer))
                        .to_string_lossy()
                        .into_owned()
                })
                .collect()
        }
    }

    fn pick_layer(&mut self, wanted: Option<&str>) -> Result<(), SourceError> {
        let names = self.layer_names();
        if self.is_cad {
            // A CAD drawing is one OGR layer; its own layers are an attribute.
            if let Some(name) = wanted {
                let filter = format!("Layer = '{}'", name.replace('\'', "''"));
                let mut layer = self.layer()?;
                let filtered = layer.set_attribute_filter(&filter);
                if filtered.is_err() || layer.feature_count() == 0 {
                    return Err(SourceError::NoLayer {
                        path: self.path.clone(),
                        wanted: Some(name.to_owned()),
                        layers: self.cad_layers()?,
                    });
                }
                self.cad_filter = Some(filter);
            }
            return Ok(());
        }
        let choice = match wanted {
            Some(name) => names.iter().position(|layer| layer == name),
            None if self.is_osm => names.iter().position(|layer| layer == "multipolygons"),
            None => {
                let layers = (0..).zip(self.dataset.layers());
                let mut areas = layers.filter(|(_, layer)| may_hold_areas(layer.defn()));
                match (areas.next(), areas.next()) {
                    (Some((index, _)), None) => Some(index),
                    (Some(_), Some(_)) => {
                        return Err(SourceError::SeveralLayers {
                            path: self.path.clone(),
                            layers: names,
                        });
                    }
                    _ => None,
                }
            }
        };
        self.layer_index = choice.ok_or_else(|| SourceError::NoLayer {
            path: self.path.clone(),
            wanted: wanted.map(str::to_owned),
            layers: names,
        })?;
        Ok(())
    }

    fn cad_layers(&self) -> Result<Vec<String>, SourceError> {
        let mut layer = self.layer()?;
        let _ = layer.set_attribute_filter("1 = 1");
        let mut names: Vec<String> = layer
            .features()
            .filter_map(|feature| feature.field_as_string(feature.field_index("Layer").ok()?).ok()?)
            .collect();
        names.sort();
        names.dedup();
        Ok(names)
    }
}

fn may_hold_areas(defn: &Defn) -> bool {
    use OGRwkbGeometryType as Kind;
    let kind = gdal::vector::geometry_type_flatten(defn.geometry_type());
    !matches!(
        kind,
        Kind::wkbNone | Kind::wkbPoint | Kind::wkbMultiPoint | Kind::wkbLineString | Kind::wkbMultiLineString
    )
}

/// Opens a dataset; with `drivers` by one of those alone, whatever else the file pretends to be.
pub(super) fn open_vector(path: &Path, drivers: Option<&[&str]>) -> Result<Dataset, SourceError> {
    let zipped = path.extension().is_some_and(|extension| extension == "zip");
    let name = if zipped { in_zip(path) } else { path.to_owned() };
    Dataset::open_ex(
        &name,
        DatasetOptions {
            open_flags: GdalOpenFlags::GDAL_OF_VECTOR
                | GdalOpenFlags::GDAL_OF_READONLY
                | GdalOpenFlags::GDAL_OF_VERBOSE_ERROR,
            allowed_drivers: drivers,
            ..DatasetOptions::default()
        },
    )
    .map_err(|error| SourceError::Open {
        path: path.to_owned(),
        why: gdal_says(&error),
        expected: "vector file",
    })
    .and_then(|dataset| require_end(path, &dataset.driver().short_name()).map(|()| dataset))
}
