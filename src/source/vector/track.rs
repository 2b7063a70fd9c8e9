//! Tracks of GPX, KML and other vector files: points in their order, with elevation and time where they have them.

use std::path::Path;

use gdal::vector::{Geometry, LayerAccess, OGRwkbGeometryType, geometry_type_flatten};
use glam::DVec2;

use super::feature::column_text;
use super::footprint_source::open_vector;
use crate::source::{CrsChoice, SourceError, SourceRole, gdal_says, require_sound};
use crate::space::{Crs, PointTransform};

/// A point of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// Metres in the city's CRS.
    pub position: DVec2,
    /// Metres above the vertical datum, where the file says them.
    pub elevation_m: Option<f64>,
    /// Seconds since 1970, where the file says them.
    pub time_s: Option<f64>,
}

/// Layers of GPX that hold a recorded track, a planned route, and their points; the first that holds anything counts.
const POINT_LAYERS: [&str; 2] = ["track_points", "route_points"];
/// Most points of a track.
const MAX_POINTS: usize = 2_000_000;

/// Reads the first track of a file into a city's CRS.
///
/// # Errors
/// When the file cannot be read, or holds no track.
pub fn read_track(path: &Path, city: &Crs) -> Result<Vec<TrackPoint>, SourceError> {
    require_sound(path)?;
    let dataset = open_vector(path, Some(&["GPX", "KML", "LIBKML"]))?;
    let read_error = |why: String| SourceError::Read {
        path: path.to_owned(),
        why,
    };
    let names: Vec<String> = dataset.layers().map(|layer| layer.name()).collect();
    let points_first = names.iter().filter(|name| POINT_LAYERS.contains(&name.as_str()));
    let others = names.iter().filter(|name| !POINT_LAYERS.contains(&name.as_str()));
    for name in points_first.chain(others) {
        let mut layer = dataset
            .layer_by_name(name)
            .map_err(|error| read_error(gdal_says(&error)))?;
        let own = CrsChoice::new(None, Some(city)).of_file(path, layer.spatial_ref(), SourceRole::Track)?;
        let to_city = PointTransform::new(&own, city).map_err(|source| SourceError::Crs {
            path: path.to_owned(),
            source,
        })?;
        let column = |wanted: &str| layer.defn().field_index(wanted).ok();
        let (elevation, time) = (column("ele"), column("time"));
        let mut track = Vec::new();
        for feature in layer.features() {
            let Some(geometry) = feature.geometry() else {
                continue;
            };
            let mut vertices = Vec::new();
            collect(geometry, &mut vertices);
            let is_line = vertices.len() > 1;
            // A field that is not set reads as 0.
            let is_set = |index: &usize| column_text(&feature, *index).is_some();
            let said = elevation
                .filter(is_set)
                .and_then(|index| feature.field_as_double(index).ok().flatten());
            let instant = time
                .filter(is_set)
                .and_then(|index| feature.field_as_datetime(index).ok().flatten());
            for [x, y, z] in vertices {
                if let Some(position) = to_city.point(DVec2::new(x, y)) {
                    track.push(TrackPoint {
                        position,
                        elevation_m: said.or(Some(z).filter(|&z| z != 0.0 && z.is_finite())),
                        time_s: instant.map(|instant| instant.timestamp_millis() as f64 * 1e-3),
                    });
                }
            }
            if track.len() > MAX_POINTS {
                return Err(read_error(format!(
                    "has more than {MAX_POINTS} points; thin it out"
                )));
            }
            // A line is a track of its own; the first counts.
            if is_line {
                break;
            }
        }
        if track.len() >= 2 {
            return Ok(track);
        }
    }
    Err(SourceError::NoTrack {
        path: path.to_owned(),
    })
}

/// Points and vertices of lines.
fn collect(geometry: &Geometry, vertices: &mut Vec<[f64; 3]>) {
    match geometry_type_flatten(geometry.geometry_type()) {
        OGRwkbGeometryType::wkbPoint | OGRwkbGeometryType::wkbLineString => {
            let mut points = Vec::new();
            geometry.get_points(&mut points);
            vertices.extend(points.into_iter().map(|(x, y, z)| [x, y, z]));
        }
        OGRwkbGeometryType::wkbMultiLineString | OGRwkbGeometryType::wkbGeometryCollection => {
            for index in 0..geometry.geometry_count() {
                collect(&geometry.get_geometry(index), vertices);
            }
        }
        _ => {}
    }
}
