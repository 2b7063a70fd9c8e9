//! A footprint file opened with OGR, and its layer (`reading` takes the footprints out).

use std::path::{Path, PathBuf};

use gdal::vector::{Defn, LayerAccess, OGRwkbGeometryType};
use gdal::{Dataset, DatasetOptions, GdalOpenFlags};
use glam::DVec2;

use super::cityjson;
use crate::source::{CrsChoice, HeightRule, SourceError, gdal_reference, gdal_says};
use crate::space::{Crs, GeoArea};

/// One layer of a vector file.
pub struct FootprintSource {
    pub(super) path: PathBuf,
    pub(super) dataset: Dataset,
    pub(super) layer_index: usize,
    pub(super) crs: Crs,
    pub(super) is_osm: bool,
    /// Lines count as outlines: CAD drawings have no areas.
    pub(super) is_cad: bool,
    pub(super) is_cityjson: bool,
    /// Building ids: the feature's place (source files) or its FID (the footprint dataset of record).
    pub(super) ids_are_fids: bool,
    /// The driver ends a damaged file like a whole one; its error messages and its own count tell.
    pub(super) reads_past_damage: bool,
}

impl FootprintSource {
    /// Opens a file and picks its layer: the named one, or the only one with areas.
    pub fn open(path: &Path, layer: Option<&str>, choice: &CrsChoice) -> Result<Self, SourceError> {
        let (dataset, cityjson_crs, is_cityjson) = match cityjson::virtual_path(path) {
            Some(virtual_path) => {
                let (dataset, crs) = cityjson::open(path, &virtual_path)?;
                (dataset, crs, true)
            }
            None => (open_vector(path)?, None, false),
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
            crs: Crs::from_text("EPSG:4326").map_err(|source| SourceError::Crs {
                path: path.to_owned(),
                source,
            })?,
            is_osm,
            is_cad,
            is_cityjson,
            ids_are_fids: false,
            reads_past_damage: ["FlatGeobuf", "ESRI Shapefile", "GPKG"].contains(&driver.as_str()),
        };
        source.pick_layer(layer)?;
        let own = match cityjson_crs {
            Some(crs) => gdal_reference(&crs).ok(),
            None => source.layer()?.spatial_ref(),
        };
        source.crs = choice.of_file(path, own, "--buildings-crs")?;
        Ok(source)
    }

    /// Opens a city's footprint dataset of record, where a building's id is its FID.
    pub fn open_footprint_dataset(path: &Path) -> Result<Self, SourceError> {
        let mut source = Self::open(
            path,
            Some(super::footprint_dataset::LAYER),
            &CrsChoice::as_the_file_says(),
        )?;
        source.ids_are_fids = true;
        Ok(source)
    }

    /// The rule to use when none was asked for: CityJSON knows the height of its own geometry.
    pub fn default_rule(&self) -> HeightRule {
        if self.is_cityjson {
            HeightRule::Height {
                field: cityjson::GEOMETRY_HEIGHT.to_owned(),
            }
        } else {
            HeightRule::Default
        }
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

    fn pick_layer(&mut self, wanted: Option<&str>) -> Result<(), SourceError> {
        let layers: Vec<(String, bool)> = self
            .dataset
            .layers()
            .map(|layer| (layer.name(), may_hold_areas(layer.defn())))
            .collect();
        let names = || {
            let list: Vec<&str> = layers.iter().map(|(name, _)| name.as_str()).collect();
            list.join(", ")
        };
        if self.is_cad {
            // A CAD drawing is one OGR layer; its own layers are an attribute.
            if let Some(name) = wanted {
                let filter = format!("Layer = '{}'", name.replace('\'', "''"));
                let mut layer = self.layer()?;
                let filtered = layer.set_attribute_filter(&filter);
                if filtered.is_err() || layer.feature_count() == 0 {
                    return Err(self.unfit(
                        format!("has no entities on a layer '{name}'"),
                        format!("its layers are {}", self.cad_layers()?.join(", ")),
                    ));
                }
            }
            return Ok(());
        }
        let choice = match wanted {
            Some(name) => layers.iter().position(|(layer, _)| layer == name),
            None if self.is_osm => layers.iter().position(|(layer, _)| layer == "multipolygons"),
            None => {
                let mut areas = (0..).zip(&layers).filter(|(_, (_, areas))| *areas);
                match (areas.next(), areas.next()) {
                    (Some((index, _)), None) => Some(index),
                    (Some(_), Some(_)) => {
                        return Err(self.unfit(
                            format!("has several layers ({})", names()),
                            "choose one with --layer NAME".to_owned(),
                        ));
                    }
                    _ => None,
                }
            }
        };
        self.layer_index = choice.ok_or_else(|| match wanted {
            Some(name) => self.unfit(
                format!("has no layer '{name}'"),
                format!("its layers are {}", names()),
            ),
            None => self.unfit(
                format!("has no layer of areas (it has: {})", names()),
                "give a file of building footprints (polygons)".to_owned(),
            ),
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

    pub(super) fn unfit(&self, what: String, advice: String) -> SourceError {
        SourceError::Unfit {
            path: self.path.clone(),
            what,
            advice,
        }
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

fn open_vector(path: &Path) -> Result<Dataset, SourceError> {
    let zipped = path.extension().is_some_and(|extension| extension == "zip");
    let name = if zipped {
        super::cityjson::in_zip(path)
    } else {
        path.to_owned()
    };
    Dataset::open_ex(
        &name,
        DatasetOptions {
            open_flags: GdalOpenFlags::GDAL_OF_VECTOR
                | GdalOpenFlags::GDAL_OF_READONLY
                | GdalOpenFlags::GDAL_OF_VERBOSE_ERROR,
            ..DatasetOptions::default()
        },
    )
    .map_err(|error| SourceError::Open {
        path: path.to_owned(),
        why: gdal_says(&error),
        expected: "vector file",
    })
}
