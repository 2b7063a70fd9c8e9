//! What lies on the ground besides buildings: roads, rails, water and green, from any vector file that OGR reads.

use std::path::Path;

use gdal::vector::{Defn, Feature, Geometry, LayerAccess, OGRwkbGeometryType, geometry_type_flatten};
use geo::Coord;

use super::feature::{FieldPlace, linearised};
use super::footprint_source::open_vector;
use super::heights::OTHER_TAGS;
use super::known_fields::plain;
use crate::source::{CrsChoice, SourceError, SourceRole, gdal_says};
use crate::space::{Bounds, Crs, PointTransform};

/// What a layer shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PlanKind {
    /// Parks, woods, fields.
    Green,
    /// Rivers, lakes, the sea.
    Water,
    /// Railways.
    Rail,
    /// Streets and paths.
    Road,
}

/// One line or area.
#[derive(Clone, Debug)]
pub struct PlanFeature {
    /// What it is.
    pub kind: PlanKind,
    /// Width of a line, metres; none of an area.
    pub width_m: Option<f64>,
    /// Lines, or rings of an area (even-odd), in the city's CRS.
    pub parts: Vec<Vec<Coord<f64>>>,
}

impl PlanFeature {
    /// Its rectangle, with the line's width.
    pub fn bounds(&self) -> Bounds {
        let half = 0.5 * self.width_m.unwrap_or(0.0);
        self.parts.iter().flatten().fold(Bounds::EMPTY, |bounds, point| {
            bounds.union(&Bounds {
                west: point.x - half,
                south: point.y - half,
                east: point.x + half,
                north: point.y + half,
            })
        })
    }
}

/// Widths of classes, metres: OpenStreetMap's `highway`, carriageway and pavements, after its wiki's usual values.
const ROAD_WIDTHS: &[(&str, f64)] = &[
    ("motorway", 14.0),
    ("trunk", 12.0),
    ("primary", 11.0),
    ("secondary", 9.5),
    ("tertiary", 8.5),
    ("unclassified", 7.0),
    ("residential", 7.0),
    ("living_street", 6.0),
    ("pedestrian", 6.0),
    ("service", 4.0),
    ("track", 3.0),
    ("footway", 2.2),
    ("path", 1.8),
    ("cycleway", 2.5),
    ("steps", 2.0),
    ("bridleway", 2.0),
    ("corridor", 0.0),
    ("proposed", 0.0),
    ("construction", 0.0),
];
const USUAL_ROAD_M: f64 = 6.5;
/// Of `waterway`.
const WATER_WIDTHS: &[(&str, f64)] = &[
    ("river", 14.0),
    ("canal", 9.0),
    ("stream", 2.5),
    ("ditch", 1.5),
    ("drain", 1.5),
];
const USUAL_WATER_M: f64 = 4.0;
const RAIL_M: f64 = 3.5;
/// Names of a width, metres: OpenStreetMap, BD TOPO, plain words.
const WIDTH_FIELDS: &[&str] = &[
    "width",
    "LARGEUR",
    "largeur_de_chaussee",
    "breite",
    "width_m",
    "ancho",
];
/// Width of a lane, metres.
const LANE_M: f64 = 3.2;
/// Values of OpenStreetMap's `leisure`, `landuse` and `natural` that are green.
const GREEN: &[&str] = &[
    "park",
    "garden",
    "pitch",
    "golf_course",
    "nature_reserve",
    "playground",
    "grass",
    "forest",
    "meadow",
    "recreation_ground",
    "village_green",
    "cemetery",
    "orchard",
    "vineyard",
    "allotments",
    "farmland",
    "wood",
    "scrub",
    "grassland",
    "heath",
];
/// Values of `natural`, `landuse` that are water.
const WATER: &[&str] = &["water", "bay", "reservoir", "basin", "salt_pond", "wetland"];

/// Places of a layer's fields.
struct Fields {
    names: Vec<String>,
    tags: Option<FieldPlace>,
}

impl Fields {
    fn new(defn: &Defn) -> Self {
        Self {
            names: defn.fields().map(|field| plain(&field.name())).collect(),
            tags: defn.field_index(OTHER_TAGS).ok().map(FieldPlace::OtherTags),
        }
    }
}

/// A feature's attributes by the names that are asked.
struct Tags<'a> {
    feature: &'a Feature<'a>,
    fields: &'a Fields,
}

impl Tags<'_> {
    fn text(&self, key: &str) -> Option<String> {
        let column = self.fields.names.iter().position(|name| *name == plain(key));
        let place = column.map(FieldPlace::Column).or(self.fields.tags)?;
        place
            .text(self.feature, key)
            .map(|text| text.trim().to_lowercase())
    }

    fn metres(&self) -> Option<f64> {
        let number = |text: String| {
            text.trim_end_matches('m')
                .trim()
                .replace(',', ".")
                .parse::<f64>()
                .ok()
        };
        let told = WIDTH_FIELDS.iter().find_map(|key| number(self.text(key)?));
        let lanes = || Some(LANE_M * number(self.text("lanes")?)?);
        told.or_else(lanes).filter(|metres| (0.3..200.0).contains(metres))
    }
}

/// Width of a line (0 is not shown), or that an area is shown; none where the feature is something else.
fn width_of(kind: PlanKind, tags: &Tags<'_>, is_osm: bool) -> Option<f64> {
    let class = |key: &str, widths: &[(&str, f64)], usual: f64| {
        let value = tags.text(key)?;
        let value = value.trim_end_matches("_link");
        let known = widths.iter().find(|(name, _)| *name == value);
        Some(known.map_or(usual, |(_, metres)| *metres))
    };
    let is_any = |keys: &[&str], values: &[&str]| {
        let is_one = |key: &&str| {
            tags.text(key)
                .is_some_and(|value| values.contains(&value.as_str()))
        };
        keys.iter().any(is_one)
    };
    let by_class = match kind {
        PlanKind::Road => class("highway", ROAD_WIDTHS, USUAL_ROAD_M),
        PlanKind::Rail => class(
            "railway",
            &[("abandoned", 0.0), ("subway", 0.0), ("platform", 0.0)],
            RAIL_M,
        ),
        PlanKind::Water => class("waterway", WATER_WIDTHS, USUAL_WATER_M)
            .or_else(|| is_any(&["natural", "landuse"], WATER).then_some(USUAL_WATER_M)),
        PlanKind::Green => is_any(&["leisure", "landuse", "natural"], GREEN).then_some(2.0),
    };
    let usual = match kind {
        PlanKind::Road => USUAL_ROAD_M,
        PlanKind::Rail => RAIL_M,
        PlanKind::Water => USUAL_WATER_M,
        PlanKind::Green => 2.0,
    };
    let width = match is_osm {
        true => by_class?,
        // Another file's layer is what the user says it is.
        false => by_class.unwrap_or(usual),
    };
    Some(if width > 0.0 {
        tags.metres().unwrap_or(width)
    } else {
        0.0
    })
}

/// Reads all lines and areas of a file that are of a kind and meet a rectangle, into the city's CRS.
///
/// # Errors
/// When the file cannot be read, or has none.
pub fn read_plan(
    path: &Path,
    kind: PlanKind,
    (city, extent): (&Crs, &Bounds),
) -> Result<Vec<PlanFeature>, SourceError> {
    let read_error = |why: String| SourceError::Read {
        path: path.to_owned(),
        why,
    };
    let dataset = open_vector(path, None)?;
    let is_osm = dataset.driver().short_name() == "OSM";
    let mut features = Vec::new();
    let mut found = 0_u64;
    for index in 0..dataset.layer_count() {
        let mut layer = dataset
            .layer(index)
            .map_err(|error| read_error(gdal_says(&error)))?;
        if is_osm && !["lines", "multipolygons"].contains(&layer.name().as_str()) {
            continue;
        }
        let own = layer.spatial_ref();
        let crs = CrsChoice::new(None, Some(city)).of_file(path, own, SourceRole::Plan)?;
        let transform = PointTransform::new(&crs, city).map_err(|error| SourceError::WrongCrs {
            path: path.to_owned(),
            role: SourceRole::Plan,
            why: error.to_string(),
        })?;
        let fields = Fields::new(layer.defn());
        for feature in layer.features() {
            let tags = Tags {
                feature: &feature,
                fields: &fields,
            };
            let Some(width) = width_of(kind, &tags, is_osm).filter(|width| *width > 0.0) else {
                continue;
            };
            if let Some(geometry) = feature.geometry() {
                collect(geometry, &mut |parts, is_area| {
                    let feature = PlanFeature {
                        kind,
                        width_m: (!is_area).then_some(width),
                        parts: moved(parts, &transform),
                    };
                    found += 1;
                    if meets(&feature.bounds(), extent) {
                        features.push(feature);
                    }
                });
            }
        }
    }
    match found {
        0 => Err(read_error(format!("it has no {}", kind.names()))),
        _ => Ok(features),
    }
}

impl PlanKind {
    /// What features of it are called.
    pub fn names(self) -> &'static str {
        match self {
            Self::Road => "roads",
            Self::Rail => "rails",
            Self::Water => "water",
            Self::Green => "green",
        }
    }
}

fn meets(a: &Bounds, b: &Bounds) -> bool {
    a.west <= b.east && a.east >= b.west && a.south <= b.north && a.north >= b.south
}

fn moved(mut parts: Vec<Vec<Coord<f64>>>, transform: &PointTransform) -> Vec<Vec<Coord<f64>>> {
    for part in &mut parts {
        let (mut xs, mut ys): (Vec<f64>, Vec<f64>) = part.iter().map(|point| (point.x, point.y)).unzip();
        transform.points(&mut xs, &mut ys);
        let places = xs.into_iter().zip(ys).map(|(x, y)| Coord { x, y });
        *part = places
            .filter(|point| point.x.is_finite() && point.y.is_finite())
            .collect();
    }
    parts
}

/// Hands on every line and every area (its rings) of a geometry.
fn collect(geometry: &Geometry, each: &mut impl FnMut(Vec<Vec<Coord<f64>>>, bool)) {
    let linear = linearised(geometry);
    let geometry = linear.as_ref().unwrap_or(geometry);
    let points = |geometry: &Geometry| {
        let mut points = Vec::new();
        geometry.get_points(&mut points);
        points.iter().map(|&(x, y, _)| Coord { x, y }).collect::<Vec<_>>()
    };
    match geometry_type_flatten(geometry.geometry_type()) {
        OGRwkbGeometryType::wkbLineString => each(vec![points(geometry)], false),
        OGRwkbGeometryType::wkbPolygon => {
            let rings = (0..geometry.geometry_count()).map(|index| points(&geometry.get_geometry(index)));
            each(rings.collect(), true);
        }
        _ => {
            for index in 0..geometry.geometry_count() {
                collect(&geometry.get_geometry(index), each);
            }
        }
    }
}
