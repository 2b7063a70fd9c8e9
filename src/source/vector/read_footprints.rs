//! The stream of cleaned footprints that an opened file gives.

use std::collections::{BTreeMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};

use gdal::vector::{Feature, Layer, LayerAccess, OGRwkbGeometryType};
use geo::MultiPolygon;
use rayon::prelude::*;

use super::clean::{CleanReport, clean_outline};
use super::dataset_editor::columns_of;
use super::feature::{collect_polygons, column_text};
use super::file_end::rows_beside;
use super::footprint_source::FeatureIds;
use super::heights::{HeightReader, ReadHeight};
use super::outline::Outline;
use super::traits::TraitReader;
use super::{FootprintDatasetWriter, FootprintReport, FootprintSource};
use crate::source::{
    BuildingTraits, Footprint, HeightRule, SourceError, SourceRole, gdal_failure, gdal_says, reset_gdal_error,
};
use crate::space::{Bounds, Crs, PointTransform};

/// A cleaned outline with what was changed, or why there is none.
type Cleaned = Result<(MultiPolygon<f64>, CleanReport), &'static str>;

/// Features cleaned in parallel at a time.
const BATCH: usize = 8192;

/// A feature taken out of OGR's hands.
struct Raw {
    fid: u32,
    outline: Outline,
    height: ReadHeight,
    traits: BuildingTraits,
    rejected: Option<&'static str>,
}

/// Which features of a layer to read.
#[derive(Clone, Copy, Debug)]
pub enum Selection<'a> {
    /// All of them.
    All,
    /// Those with one of these ids.
    Fids(&'a [u32]),
}

impl FootprintSource {
    /// Reads every feature into the city's CRS; those that can be buildings go to `each`.
    pub fn read(
        &self,
        city: &Crs,
        rule: &HeightRule,
        default_height_m: f64,
        each: impl FnMut(Footprint),
    ) -> Result<FootprintReport, SourceError> {
        self.read_selected(Selection::All, (city, rule, default_height_m), each)
    }

    /// The same for some of the features. `to`: the city's CRS, the height rule and the default height, metres.
    pub fn read_selected(
        &self,
        selection: Selection<'_>,
        (city, rule, default_height_m): (&Crs, &HeightRule, f64),
        mut each: impl FnMut(Footprint),
    ) -> Result<FootprintReport, SourceError> {
        let mut layer = self.layer()?;
        select(&mut layer, self.cad_filter.as_deref(), selection)
            .map_err(|error| self.read_error(gdal_says(&error)))?;
        let heights = HeightReader::new(self, layer.defn(), rule, default_height_m)?;
        let traits = TraitReader::new(layer.defn());
        let building_field = self
            .is_osm
            .then(|| layer.defn().field_index("building").ok())
            .flatten();
        let mut report = FootprintReport::new(rule);
        let mut seen = HashSet::new();
        let mut index: u32 = 0;
        let counted = match self.reads_past_damage {
            true => layer.feature_count(),
            false => rows_beside(&self.path),
        };
        let mut features = layer.features();
        let mut last_failure: Option<String> = None;
        loop {
            let mut batch: Vec<Raw> = Vec::new();
            while batch.len() < BATCH {
                // OGR ends a damaged file like a finished one, and says so with the last feature or after it.
                reset_gdal_error();
                let next = features.next();
                let failure = gdal_failure();
                // With a feature it may be that feature's alone, if whole ones follow.
                if let Some(why) = failure.clone().filter(|_| self.reads_past_damage) {
                    return Err(self.read_error(why));
                }
                let Some(feature) = next else {
                    if let Some(why) = failure.or(last_failure.take()) {
                        return Err(self.read_error(why));
                    }
                    break;
                };
                last_failure = failure;
                index += 1;
                let (outline, rejected) = self.outline(&feature, building_field);
                batch.push(Raw {
                    fid: self.id(&feature, index).unwrap_or(0),
                    outline,
                    height: heights.read(&feature),
                    traits: traits.read(&feature),
                    rejected: rejected.or(self.id(&feature, index).is_none().then_some("no fid")),
                });
            }
            if batch.is_empty() {
                break;
            }
            report.read += batch.len() as u64;
            let cleaned = self.clean(&batch, city)?;
            for (raw, outline) in batch.into_iter().zip(cleaned) {
                let (outline, changes) = match outline {
                    Ok(cleaned) => cleaned,
                    Err(why) => {
                        report.reject(why);
                        continue;
                    }
                };
                let is_as_stored = is_same(&raw.outline, &outline);
                count_changes(&mut report, changes);
                report.kept += 1;
                report.unusable_height(raw.height.unusable);
                if !seen.insert(fingerprint(&outline)) {
                    report.duplicates += 1;
                }
                each(Footprint {
                    fid: raw.fid,
                    outline,
                    roof: raw.height.roof,
                    height_origin: raw.height.origin,
                    traits: raw.traits,
                    is_as_stored,
                });
            }
        }
        if report.read < counted {
            let why = format!("{} of {counted} features could be read", report.read);
            return Err(self.read_error(why));
        }
        Ok(report)
    }

    /// Ids of the features whose rectangles, rounded outwards, meet one in the layer's CRS: by the GeoPackage's R-tree (OGC
    /// 12-128r18, annex F.3), or all of them where there is none.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn fids_meeting(&self, bounds: &Bounds) -> Result<Vec<u32>, SourceError> {
        let layer = self.layer()?;
        // SAFETY: the layer is alive, and its text is copied at once.
        let column = unsafe { std::ffi::CStr::from_ptr(gdal_sys::OGR_L_GetGeometryColumn(layer.c_layer())) };
        let index = format!("rtree_{}_{}", layer.name(), column.to_string_lossy()).replace('"', "\"\"");
        let Bounds {
            west,
            south,
            east,
            north,
        } = bounds;
        let query = format!(
            "SELECT id FROM \"{index}\" WHERE maxx >= {west:?} AND minx <= {east:?} AND maxy >= {south:?} AND miny <= {north:?}"
        );
        let dialect = gdal::vector::sql::Dialect::DEFAULT;
        if let Ok(Some(mut rows)) = self.dataset.execute_sql(query, None, dialect) {
            let ids = rows.features().map(|row| row.field_as_integer64(0));
            return Ok(ids.filter_map(|id| u32::try_from(id.ok()??).ok()).collect());
        }
        let mut layer = self.layer()?;
        layer.clear_attribute_filter();
        Ok((1..)
            .zip(layer.features())
            .filter_map(|(index, feature)| self.id(&feature, index))
            .collect())
    }

    /// Writes the features that became buildings, with their attributes as they are, to a footprint dataset; `outline`
    /// gives the building's by its id. Returns how many were written.
    pub fn copy_to<'a>(
        &self,
        dataset: &mut FootprintDatasetWriter,
        outline: impl Fn(u32) -> Option<&'a MultiPolygon<f64>>,
    ) -> Result<u64, SourceError> {
        let mut layer = self.layer()?;
        select(&mut layer, self.cad_filter.as_deref(), Selection::All)
            .map_err(|error| self.read_error(gdal_says(&error)))?;
        dataset.copy_fields(layer.defn())?;
        let mut written = 0;
        for (index, feature) in (1..).zip(layer.features()) {
            if let Some(fid) = self.id(&feature, index)
                && let Some(outline) = outline(fid)
            {
                dataset.add(&feature, fid, outline)?;
                written += 1;
            }
        }
        Ok(written)
    }

    /// Writes changed features as `known`, the dataset that they change, will hold them: its fields, the attributes it has, and over
    /// them what the features say. `outlines`: theirs, by id.
    ///
    /// # Errors
    /// When a file cannot be read or written.
    pub fn merge_to(
        &self,
        dataset: &mut FootprintDatasetWriter,
        known: &Self,
        (outlines, replaces_attributes): (&BTreeMap<u32, MultiPolygon<f64>>, bool),
    ) -> Result<(), SourceError> {
        let (mut layer, known) = (self.layer()?, known.layer()?);
        select(&mut layer, self.cad_filter.as_deref(), Selection::All)
            .map_err(|error| self.read_error(gdal_says(&error)))?;
        dataset.copy_fields(known.defn())?;
        let mut columns = columns_of(layer.defn(), known.defn());
        if let FeatureIds::Column(column) = self.ids {
            columns[column] = -1;
        }
        let mut written = HashSet::new();
        for (index, changed) in (1..).zip(layer.features()) {
            if let Some(fid) = self.id(&changed, index)
                && let Some(outline) = outlines.get(&fid)
                && written.insert(fid)
            {
                let before = match replaces_attributes {
                    true => None,
                    false => known.feature(u64::from(fid)),
                };
                dataset.add_merged((before.as_ref(), &changed), &columns, fid, outline)?;
            }
        }
        match written.len() == outlines.len() {
            true => Ok(()),
            false => Err(self.read_error("it changed while it was read".to_owned())),
        }
    }

    /// A building's id, from 1; none where its place for it is empty.
    fn id(&self, feature: &Feature<'_>, index: u32) -> Option<u32> {
        let fid = |fid: Option<i64>| u32::try_from(fid?).ok().filter(|&fid| fid > 0);
        match self.ids {
            FeatureIds::Own => fid(feature.fid().and_then(|fid| i64::try_from(fid).ok())),
            FeatureIds::Column(column) => {
                fid(column_text(feature, column).and_then(|text| whole_number(&text)))
            }
            FeatureIds::Index => Some(index),
        }
    }

    /// Rings as the file gives them, and why the feature cannot be a building.
    fn outline(
        &self,
        feature: &Feature<'_>,
        building_field: Option<usize>,
    ) -> (Outline, Option<&'static str>) {
        let mut outline = Outline::default();
        if let Some(index) = building_field {
            let tag = column_text(feature, index);
            if tag.is_none_or(|tag| tag == "no") {
                return (outline, Some("not a building (no building tag)"));
            }
        }
        let accept = if self.is_cad {
            OGRwkbGeometryType::wkbLineString
        } else {
            OGRwkbGeometryType::wkbPolygon
        };
        let rejected = match feature.geometry() {
            Some(geometry) if !geometry.is_empty() => {
                collect_polygons(geometry, &mut outline, accept);
                outline.polygons.is_empty().then_some("not an area")
            }
            _ if self.is_cityjson => {
                Some("no surface of its own (parts are features of their own), or one of too many pieces")
            }
            _ => Some("no geometry"),
        };
        (outline, rejected)
    }

    fn clean(&self, raws: &[Raw], city: &Crs) -> Result<Vec<Cleaned>, SourceError> {
        let (from, path) = (&self.crs, &self.path);
        raws.par_iter()
            .with_min_len(256)
            .map_init(
                || PointTransform::new(from, city),
                |transform, raw| {
                    if let Some(why) = raw.rejected {
                        return Ok(Err(why));
                    }
                    match transform {
                        Ok(transform) => Ok(clean_outline(&transformed(&raw.outline, transform))),
                        Err(error) => Err(SourceError::WrongCrs {
                            path: path.clone(),
                            role: SourceRole::Footprints,
                            why: error.to_string(),
                        }),
                    }
                },
            )
            .collect()
    }
}

/// A number without a fraction; OGR would take `3.7` for 3 and a word for 0.
fn whole_number(text: &str) -> Option<i64> {
    let text = text.trim();
    let whole = || text.parse::<f64>().ok().filter(|number| number.fract() == 0.0);
    text.parse().ok().or_else(|| Some(whole()? as i64))
}

fn transformed(outline: &Outline, transform: &PointTransform) -> Outline {
    if transform.is_identity() {
        return outline.clone();
    }
    let points = outline.polygons.iter().flatten().flatten();
    let (mut xs, mut ys): (Vec<f64>, Vec<f64>) = points.map(|point| (point.x, point.y)).unzip();
    transform.points(&mut xs, &mut ys);
    let mut moved = outline.clone();
    let targets = moved.polygons.iter_mut().flatten().flatten();
    for (point, (x, y)) in targets.zip(xs.into_iter().zip(ys)) {
        (point.x, point.y) = (x, y);
    }
    moved
}

/// Filters a layer; `whole` is what makes all of it.
fn select(
    layer: &mut Layer<'_>,
    whole: Option<&str>,
    selection: Selection<'_>,
) -> Result<(), gdal::errors::GdalError> {
    layer.clear_spatial_filter();
    layer.clear_attribute_filter();
    match selection {
        Selection::All => whole.map_or(Ok(()), |filter| layer.set_attribute_filter(filter)),
        Selection::Fids(fids) => {
            let list: Vec<String> = fids.iter().map(u32::to_string).collect();
            // SAFETY: the layer is alive; the column's name is copied at once.
            let column = unsafe { std::ffi::CStr::from_ptr(gdal_sys::OGR_L_GetFIDColumn(layer.c_layer())) };
            let column = column.to_string_lossy().replace('"', "\"\"");
            layer.set_attribute_filter(&format!("\"{column}\" IN ({})", list.join(",")))
        }
    }
}

/// Whether an outline is, coordinate by coordinate, what the file holds.
fn is_same(stored: &Outline, outline: &MultiPolygon<f64>) -> bool {
    let polygons = outline.0.iter().map(|polygon| {
        let rings = std::iter::once(polygon.exterior()).chain(polygon.interiors());
        rings.map(|ring| ring.0.as_slice())
    });
    stored.polygons.len() == outline.0.len()
        && stored
            .polygons
            .iter()
            .zip(polygons)
            .all(|(rings, outline)| rings.iter().map(Vec::as_slice).eq(outline))
}

fn count_changes(report: &mut FootprintReport, changes: CleanReport) {
    for (changed, what) in [
        (changes.merged_points, "repeated points merged"),
        (changes.closed, "open polylines closed"),
        (changes.rebuilt, "self-crossing or invalid outlines rebuilt"),
        (changes.dropped_rings, "rings without area dropped"),
    ] {
        if changed {
            report.repair(what);
        }
    }
}

fn fingerprint(outline: &MultiPolygon<f64>) -> u64 {
    let mut hasher = DefaultHasher::new();
    super::feature::wkb_of(outline).hash(&mut hasher);
    hasher.finish()
}
