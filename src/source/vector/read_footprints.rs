//! The stream of cleaned footprints that an opened file gives.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use gdal::vector::{Feature, LayerAccess, OGRwkbGeometryType};
use geo::MultiPolygon;
use rayon::prelude::*;

use super::clean::{CleanReport, clean_outline};
use super::feature::{collect_polygons, column_text};
use super::heights::{HeightReader, ReadHeight};
use super::outline::Outline;
use super::{FootprintDatasetWriter, FootprintReport, FootprintSource};
use crate::source::{Footprint, HeightRule, SourceError, SourceRole};
use crate::space::{Crs, PointTransform};

/// A cleaned outline with what was changed, or why there is none.
type Cleaned = Result<(MultiPolygon<f64>, CleanReport), &'static str>;

/// Features cleaned in parallel at a time.
const BATCH: usize = 8192;

/// A feature taken out of OGR's hands.
struct Raw {
    fid: u32,
    outline: Outline,
    height: ReadHeight,
    rejected: Option<&'static str>,
}

impl FootprintSource {
    /// Reads every feature into the city's CRS; those that can be buildings go to `each`.
    pub fn read(
        &self,
        city: &Crs,
        rule: &HeightRule,
        default_height_m: f64,
        mut each: impl FnMut(Footprint),
    ) -> Result<FootprintReport, SourceError> {
        let mut layer = self.layer()?;
        let heights = HeightReader::new(self, layer.defn(), rule, default_height_m)?;
        let building_field = self
            .is_osm
            .then(|| layer.defn().field_index("building").ok())
            .flatten();
        let mut report = FootprintReport::new(rule);
        let mut seen = HashSet::new();
        let mut index: u32 = 0;
        let counted = if self.reads_past_damage {
            layer.feature_count()
        } else {
            0
        };
        let mut features = layer.features();
        loop {
            let mut batch: Vec<Raw> = Vec::new();
            reset_gdal_error();
            for feature in features.by_ref().take(BATCH) {
                index += 1;
                let (outline, rejected) = self.outline(&feature, building_field);
                batch.push(Raw {
                    fid: self.id(&feature, index),
                    outline,
                    height: heights.read(&feature),
                    rejected,
                });
            }
            if (batch.is_empty() || self.reads_past_damage)
                && let Some(why) = gdal_failure()
            {
                return Err(self.read_error(why));
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
                });
            }
        }
        if report.read < counted {
            let why = format!("{} of {counted} features could be read", report.read);
            return Err(self.read_error(why));
        }
        Ok(report)
    }

    /// Writes the features that became buildings, with their attributes as they are, to a footprint dataset; `outline`
    /// gives the building's by its id. Returns how many were written.
    pub fn copy_to<'a>(
        &self,
        dataset: &mut FootprintDatasetWriter,
        outline: impl Fn(u32) -> Option<&'a MultiPolygon<f64>>,
    ) -> Result<u64, SourceError> {
        let mut layer = self.layer()?;
        dataset.copy_fields(layer.defn())?;
        let mut written = 0;
        for (index, feature) in (1..).zip(layer.features()) {
            let fid = self.id(&feature, index);
            if let Some(outline) = outline(fid) {
                dataset.add(&feature, fid, outline)?;
                written += 1;
            }
        }
        Ok(written)
    }

    /// A building's id: the feature's own where the format keeps them, else its index in the source, from 1.
    fn id(&self, feature: &Feature<'_>, index: u32) -> u32 {
        let own = self.ids_are_fids.then(|| feature.fid()).flatten();
        own.and_then(|fid| u32::try_from(fid).ok()).unwrap_or(index)
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
            _ if self.is_cityjson => Some("no surface of its own (parts are features of their own)"),
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
