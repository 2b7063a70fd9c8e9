//! The stream of cleaned footprints that an opened file gives.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use gdal::vector::{Defn, Feature, LayerAccess, OGRwkbGeometryType};
use geo::MultiPolygon;
use rayon::prelude::*;

use super::clean::{CleanReport, clean_outline};
use super::feature::{FieldPlace, collect_polygons, column_text};
use super::outline::Outline;
use super::{FootprintDatasetWriter, FootprintReport, FootprintSource};
use crate::source::{Footprint, HeightRule, RoofSpec, SourceError};
use crate::space::{Crs, PointTransform};

/// A cleaned outline with what was changed, or why there is none.
type Cleaned = Result<(MultiPolygon<f64>, CleanReport), &'static str>;

/// Features cleaned in parallel at a time.
const BATCH: usize = 8192;

/// A feature taken out of OGR's hands.
struct Raw {
    place: u32,
    outline: Outline,
    roof: Result<RoofSpec, &'static str>,
    rejected: Option<&'static str>,
}

impl FootprintSource {
    /// Reads every feature into the city's CRS; kept ones go to `each` and, with their attributes, to `map`.
    pub fn read(
        &self,
        city: &Crs,
        rule: &HeightRule,
        default_height_m: f64,
        mut map: Option<&mut FootprintDatasetWriter>,
        mut each: impl FnMut(Footprint),
    ) -> Result<FootprintReport, SourceError> {
        let mut layer = self.layer()?;
        let field = self.field_place(layer.defn(), rule)?;
        if let Some(map) = map.as_deref_mut() {
            map.copy_fields(layer.defn())?;
        }
        let building_field = self
            .is_osm
            .then(|| layer.defn().field_index("building").ok())
            .flatten();
        let mut report = FootprintReport::default();
        let mut seen = HashSet::new();
        let mut place: u32 = 0;
        let counted = if self.reads_past_damage {
            layer.feature_count()
        } else {
            0
        };
        let mut features = layer.features();
        loop {
            let mut batch: Vec<(Feature<'_>, Raw)> = Vec::new();
            reset_gdal_error();
            for feature in features.by_ref().take(BATCH) {
                place += 1;
                let id = if self.ids_are_fids {
                    feature
                        .fid()
                        .and_then(|fid| u32::try_from(fid).ok())
                        .unwrap_or(place)
                } else {
                    place
                };
                let raw = self.raw(&feature, id, rule, field, building_field);
                batch.push((feature, raw));
            }
            if batch.is_empty() {
                if let Some(why) = gdal_failure() {
                    return Err(self.read_error(why));
                }
                break;
            }
            if self.reads_past_damage
                && let Some(why) = gdal_failure()
            {
                return Err(self.read_error(why));
            }
            report.read += batch.len() as u64;
            let cleaned = self.clean(batch.iter().map(|(_, raw)| raw).collect(), city)?;
            for ((feature, raw), outline) in batch.into_iter().zip(cleaned) {
                let (outline, changes) = match outline {
                    Ok(cleaned) => cleaned,
                    Err(why) => {
                        report.reject(why);
                        continue;
                    }
                };
                count_changes(&mut report, changes);
                report.kept += 1;
                if !seen.insert(fingerprint(&outline)) {
                    report.duplicates += 1;
                }
                let default = RoofSpec::HeightAboveBase(default_height_m);
                if let Some(map) = map.as_deref_mut() {
                    map.add(&feature, raw.place, &outline)?;
                }
                each(Footprint {
                    fid: raw.place,
                    outline,
                    roof: raw.roof.unwrap_or(default),
                    default_height: raw.roof.err(),
                });
            }
        }
        if report.read < counted {
            let why = format!("{} of {counted} features could be read", report.read);
            return Err(self.read_error(why));
        }
        Ok(report)
    }

    fn field_place(&self, defn: &Defn, rule: &HeightRule) -> Result<Option<FieldPlace>, SourceError> {
        let Some(name) = rule.field() else {
            return Ok(None);
        };
        if let Ok(index) = defn.field_index(name) {
            return Ok(Some(FieldPlace::Column(index)));
        }
        if let Ok(index) = defn.field_index("other_tags")
            && (self.is_osm || self.ids_are_fids)
        {
            return Ok(Some(FieldPlace::OtherTags(index)));
        }
        let names: Vec<String> = defn.fields().map(|field| field.name()).collect();
        let advice = if names.is_empty() {
            "it has no fields at all: a shapefile needs its .dbf beside it".to_owned()
        } else {
            format!("its fields are {}", names.join(", "))
        };
        Err(self.unfit(format!("has no field '{name}'"), advice))
    }

    fn raw(
        &self,
        feature: &Feature<'_>,
        place: u32,
        rule: &HeightRule,
        field: Option<FieldPlace>,
        building_field: Option<usize>,
    ) -> Raw {
        let text = field
            .zip(rule.field())
            .and_then(|(field, key)| field.text(feature, key));
        let roof = rule.roof_from_text(text.as_deref()).ok_or(match (&text, field) {
            (_, None) => "no height field was named",
            (None, _) => "the height is missing",
            (Some(_), _) => "the height is zero, negative or not a number",
        });
        let mut raw = Raw {
            place,
            outline: Outline::default(),
            roof,
            rejected: None,
        };
        if let Some(index) = building_field {
            let tag = column_text(feature, index);
            if tag.is_none_or(|tag| tag == "no") {
                raw.rejected = Some("not a building (no building tag)");
                return raw;
            }
        }
        let accept = if self.is_cad {
            OGRwkbGeometryType::wkbLineString
        } else {
            OGRwkbGeometryType::wkbPolygon
        };
        match feature.geometry() {
            Some(geometry) if !geometry.is_empty() => {
                collect_polygons(geometry, &mut raw.outline, accept);
                if raw.outline.polygons.is_empty() {
                    raw.rejected = Some("not an area");
                }
            }
            _ if self.is_cityjson => {
                raw.rejected = Some("no surface of its own (parts are features of their own)")
            }
            _ => raw.rejected = Some("no geometry"),
        }
        raw
    }

    fn clean(&self, raws: Vec<&Raw>, city: &Crs) -> Result<Vec<Cleaned>, SourceError> {
        let (from, path) = (&self.crs, &self.path);
        raws.into_par_iter()
            .with_min_len(256)
            .map_init(
                || PointTransform::new(from, city),
                |transform, raw| {
                    if let Some(why) = raw.rejected {
                        return Ok(Err(why));
                    }
                    match transform {
                        Ok(transform) => Ok(clean_outline(&transformed(&raw.outline, transform))),
                        Err(error) => Err(SourceError::Unfit {
                            path: path.clone(),
                            what: error.to_string(),
                            advice: "name the right CRS with --buildings-crs EPSG:n".to_owned(),
                        }),
                    }
                },
            )
            .collect()
    }
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

fn reset_gdal_error() {
    // SAFETY: no arguments, thread-local state.
    unsafe { gdal_sys::CPLErrorReset() };
}

/// GDAL's last message when it was a failure: OGR ends a damaged file like a finished one.
fn gdal_failure() -> Option<String> {
    // SAFETY: the message is GDAL's thread-local buffer, copied at once.
    unsafe {
        let failed = gdal_sys::CPLGetLastErrorType() >= gdal_sys::CPLErr::CE_Failure;
        let message = std::ffi::CStr::from_ptr(gdal_sys::CPLGetLastErrorMsg());
        failed.then(|| message.to_string_lossy().into_owned())
    }
}
