//! What lies on the ground besides buildings: roads, rails, water and green, from any vector file that OGR reads.

use std::path::Path;

use gdal::vector::{Defn, Feature, Geometry, LayerAccess, OGRwkbGeometryType, geometry_type_flatten};
use geo::Coord;
use indexmap::IndexMap;

use super::feature::{FieldPlace, linearised};
use super::footprint_source::open_vector;
use super::heights::OTHER_TAGS;
use super::known_fields::plain;
use crate::source::ground_rules::{AreaRules, Colour};
use crate::source::{
    CrsChoice, GroundRules, SourceError, SourceRole, gdal_failure, gdal_says, require_sound, reset_gdal_error,
};
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
    /// Of an area, or of a line that has but one, sRGB.
    pub colour: [u8; 3],
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

/// Keys of a class that covers areas.
const AREA_KEYS: [&str; 3] = ["leisure", "landuse", "natural"];

/// How a feature is drawn: width of a line, and colour of what has one of its own.
struct Drawn {
    width_m: f64,
    colour: Colour,
}

/// Of an area, or a line of `key`; none where the feature is something else.
fn drawn_as_area(rules: &AreaRules, key: Option<&str>, tags: &Tags<'_>, is_osm: bool) -> Option<Drawn> {
    let values: Vec<String> = AREA_KEYS.iter().filter_map(|key| tags.text(key)).collect();
    let of_class = rules
        .colours
        .iter()
        .find(|(class, _)| values.contains(class))
        .map(|(_, colour)| *colour);
    let line = key.and_then(|key| tags.text(key));
    // Another file's layer is what the user says it is.
    (of_class.is_some() || line.is_some() || !is_osm).then(|| Drawn {
        width_m: width_of_class(&rules.widths_m, line.as_deref(), rules.usual_m),
        colour: of_class.unwrap_or(rules.colour),
    })
}

fn width_of_class(widths_m: &IndexMap<String, f64>, class: Option<&str>, usual_m: f64) -> f64 {
    let class = class.map(|class| class.trim_end_matches("_link"));
    class
        .and_then(|class| widths_m.get(class))
        .copied()
        .unwrap_or(usual_m)
}

/// How a feature is drawn; none where it is something else, or not drawn.
fn drawn(kind: PlanKind, rules: &GroundRules, tags: &Tags<'_>, is_osm: bool) -> Option<Drawn> {
    let line = |key: &str, widths_m: &IndexMap<String, f64>, usual_m: f64, colour: Colour| {
        let class = tags.text(key);
        (class.is_some() || !is_osm).then(|| Drawn {
            width_m: width_of_class(widths_m, class.as_deref(), usual_m),
            colour,
        })
    };
    let GroundRules {
        roads,
        rail,
        water,
        green,
    } = rules;
    let drawn = match kind {
        PlanKind::Road => line("highway", &roads.widths_m, roads.usual_m, roads.pavement),
        PlanKind::Rail => line("railway", &rail.widths_m, rail.usual_m, rail.bed),
        PlanKind::Water => drawn_as_area(water, Some("waterway"), tags, is_osm),
        PlanKind::Green => drawn_as_area(green, None, tags, is_osm),
    };
    drawn.filter(|drawn| drawn.width_m > 0.0).map(|drawn| Drawn {
        width_m: tags.metres().unwrap_or(drawn.width_m),
        ..drawn
    })
}

/// Reads all lines and areas of a file that are of a kind by the rules and meet a rectangle, into the city's CRS.
///
/// # Errors
/// When the file cannot be read, or has none.
pub fn read_plan(
    path: &Path,
    (kind, rules): (PlanKind, &GroundRules),
    (city, extent): (&Crs, &Bounds),
) -> Result<Vec<PlanFeature>, SourceError> {
    let read_error = |why: String| SourceError::Read {
        path: path.to_owned(),
        why,
    };
    require_sound(path)?;
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
        let mut features_read = layer.features();
        // A feature before the last may fail alone; the end of a damaged file looks like one of a finished file.
        let mut last_failure = None;
        loop {
            reset_gdal_error();
            let next = features_read.next();
            let failure = gdal_failure();
            let Some(feature) = next else {
                if let Some(why) = failure.or(last_failure) {
                    return Err(read_error(why));
                }
                break;
            };
            last_failure = failure;
            let tags = Tags {
                feature: &feature,
                fields: &fields,
            };
            let Some(Drawn { width_m, colour }) = drawn(kind, rules, &tags, is_osm) else {
                continue;
            };
            if let Some(geometry) = feature.geometry() {
                collect(geometry, &mut |parts, is_area| {
                    let feature = PlanFeature {
                        kind,
                        width_m: (!is_area).then_some(width_m),
                        colour: colour.0,
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
