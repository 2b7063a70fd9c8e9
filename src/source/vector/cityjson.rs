//! CityJSON 1.0 to 2.0 as an OGR layer: one feature per Building and BuildingPart, in file order.
//!
//! The footprint is the plan of the object's ground: its `GroundSurface`s where the file has semantics
//! (CityJSON 2.0.1, section 3.3), else its surfaces that face down. Heights of the geometry become the
//! attributes `geometry_height`, `geometry_zmin` and `geometry_zmax`, metres.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use gdal::vector::{
    Defn, Feature, FieldDefn, FieldValue, Geometry, LayerOptions, OGRFieldType, OGRwkbGeometryType,
};
use gdal::{Dataset, DriverManager};
use geo::{Coord, CoordsIter, LineString, MultiPolygon, Polygon, unary_union};
use glam::DVec3;
use indexmap::IndexMap;
use serde::Deserialize;
use serde_json::Value;

use super::cityjson_text::read_text;
use super::clean::is_valid;
use super::footprint_dataset::require_few_fields;
use crate::source::{SourceError, gdal_reference};
use crate::space::Crs;

/// The field that holds a CityJSON building's own height, metres.
pub const GEOMETRY_HEIGHT: &str = "geometry_height";

#[derive(Deserialize)]
struct CityJson {
    #[serde(rename = "CityObjects")]
    objects: IndexMap<String, CityObject>,
    vertices: Vec<[f64; 3]>,
    transform: Option<Quantisation>,
    #[serde(default)]
    metadata: Metadata,
}

impl CityJson {
    /// Buildings and their parts, in the file's order.
    fn buildings(&self) -> impl Iterator<Item = &CityObject> {
        let kinds = ["Building", "BuildingPart"];
        self.objects
            .values()
            .filter(move |object| kinds.contains(&object.kind.as_str()))
    }
}

#[derive(Deserialize)]
struct Quantisation {
    scale: [f64; 3],
    translate: [f64; 3],
}

#[derive(Default, Deserialize)]
struct Metadata {
    #[serde(rename = "referenceSystem")]
    reference_system: Option<String>,
    #[serde(rename = "geographicalExtent")]
    extent: Option<[f64; 6]>,
}

#[derive(Deserialize)]
struct CityObject {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    attributes: BTreeMap<String, Value>,
    #[serde(default)]
    geometry: Vec<CityGeometry>,
}

#[derive(Deserialize)]
struct CityGeometry {
    #[serde(default)]
    boundaries: Value,
    #[serde(default)]
    semantics: Option<Semantics>,
}

#[derive(Deserialize)]
struct Semantics {
    #[serde(default)]
    surfaces: Vec<SemanticSurface>,
    #[serde(default)]
    values: Value,
}

#[derive(Deserialize)]
struct SemanticSurface {
    #[serde(rename = "type")]
    kind: String,
}

/// A CityJSON file as OGR sees it.
pub struct OpenedCityJson {
    /// The layer `buildings`, in memory.
    pub dataset: Dataset,
    /// What the file names.
    pub crs: Option<Crs>,
    /// True when the file's translation was not applied.
    pub translation_dropped: bool,
}

/// Reads the file into memory.
pub fn open(path: &Path, virtual_path: &Path) -> Result<OpenedCityJson, SourceError> {
    let damaged = |why: String| SourceError::Read {
        path: path.to_owned(),
        why,
    };
    let text = read_text(virtual_path).map_err(damaged)?;
    let mut city: CityJson =
        serde_json::from_slice(&text).map_err(|error| damaged(format!("CityJSON: {error}")))?;
    let translation_dropped = drop_wrong_translation(&mut city);
    let crs = city
        .metadata
        .reference_system
        .as_deref()
        .and_then(epsg_of)
        .map(|code| Crs::from_text(&code))
        .transpose()
        .map_err(|source| SourceError::Crs {
            path: path.to_owned(),
            source,
        })?;
    let attributes = city.buildings().map(|object| object.attributes.keys());
    require_few_fields(path, attributes.flatten().collect::<BTreeSet<_>>().len())?;
    let dataset = layer_of(&city, crs.as_ref()).map_err(|error| damaged(error.to_string()))?;
    Ok(OpenedCityJson {
        dataset,
        crs,
        translation_dropped,
    })
}

/// Some writers store whole coordinates and still give a translation. The file's own extent tells: where the vertices
/// lie in it only without the translation, that is dropped; true when it was.
fn drop_wrong_translation(city: &mut CityJson) -> bool {
    let (Some(quantisation), Some(extent)) = (&mut city.transform, city.metadata.extent) else {
        return false;
    };
    let scale = DVec3::from_array(quantisation.scale);
    let inside = |translate: DVec3| {
        let within = city.vertices.iter().filter(|vertex| {
            let point = DVec3::from_array(**vertex) * scale + translate;
            (0..2).all(|axis| (extent[axis] - 1.0..=extent[axis + 3] + 1.0).contains(&point[axis]))
        });
        2 * within.count() > city.vertices.len()
    };
    let wrong = !inside(DVec3::from_array(quantisation.translate)) && inside(DVec3::ZERO);
    if wrong {
        quantisation.translate = [0.0; 3];
    }
    wrong
}

/// `EPSG:n` of an OGC name such as `https://www.opengis.net/def/crs/EPSG/0/7415` or `urn:ogc:def:crs:EPSG::7415`.
fn epsg_of(name: &str) -> Option<String> {
    let code = name.rsplit(['/', ':']).next()?;
    code.parse::<u32>().ok().map(|code| format!("EPSG:{code}"))
}

fn layer_of(city: &CityJson, crs: Option<&Crs>) -> Result<Dataset, gdal::errors::GdalError> {
    let driver =
        DriverManager::get_driver_by_name("Memory").or_else(|_| DriverManager::get_driver_by_name("MEM"))?;
    let mut dataset = driver.create_vector_only("cityjson")?;
    let srs = crs.and_then(|crs| gdal_reference(crs).ok());
    let layer = dataset.create_layer(LayerOptions {
        name: "buildings",
        srs: srs.as_ref(),
        ty: OGRwkbGeometryType::wkbMultiPolygon,
        options: None,
    })?;
    let buildings: Vec<&CityObject> = city.buildings().collect();
    let mut names: BTreeMap<&str, bool> = BTreeMap::new();
    for object in &buildings {
        for (name, value) in &object.attributes {
            if value.is_number() || value.is_string() || value.is_boolean() {
                *names.entry(name).or_insert(true) &= value.is_number();
            }
        }
    }
    for name in ["geometry_height", "geometry_zmin", "geometry_zmax"] {
        names.insert(name, true);
    }
    for (name, numeric) in &names {
        let kind = if *numeric {
            OGRFieldType::OFTReal
        } else {
            OGRFieldType::OFTString
        };
        FieldDefn::new(name, kind)?.add_to_layer(&layer)?;
    }
    let defn = Defn::from_layer(&layer);
    for object in &buildings {
        let mut values: Vec<(&str, FieldValue)> = object
            .attributes
            .iter()
            .filter_map(|(name, value)| Some((name.as_str(), field_value(value, names.get(name.as_str())?)?)))
            .collect();
        let mut geometry = Geometry::empty(OGRwkbGeometryType::wkbMultiPolygon)?;
        if let Some((plan, [low, high])) = plan_of(object, city) {
            geometry = Geometry::from_wkb(&super::feature::wkb_of(&plan))?;
            values.push(("geometry_height", FieldValue::RealValue(high - low)));
            values.push(("geometry_zmin", FieldValue::RealValue(low)));
            values.push(("geometry_zmax", FieldValue::RealValue(high)));
        }
        let mut feature = Feature::new(&defn)?;
        for (name, value) in &values {
            feature.set_field(feature.field_index(name)?, value)?;
        }
        feature.set_geometry(geometry)?;
        feature.create(&layer)?;
    }
    Ok(dataset)
}

fn field_value(value: &Value, numeric: &bool) -> Option<FieldValue> {
    match value {
        Value::Number(number) if *numeric => number.as_f64().map(FieldValue::RealValue),
        Value::Number(_) | Value::Bool(_) => Some(FieldValue::StringValue(value.to_string())),
        Value::String(text) => Some(FieldValue::StringValue(text.clone())),
        _ => None,
    }
}

/// Most vertices of surfaces that are joined to one plan: pieces that all lie over one another cross as often as the square of them.
const MAX_JOINED: usize = 16_000;

/// The ground plan and the lowest and highest vertex of an object.
fn plan_of(object: &CityObject, city: &CityJson) -> Option<(MultiPolygon<f64>, [f64; 2])> {
    let mut surfaces = Vec::new();
    for geometry in &object.geometry {
        let grounds = geometry.semantics.as_ref().map(|semantics| {
            let ground: BTreeSet<u64> = (0..)
                .zip(&semantics.surfaces)
                .filter(|(_, surface)| surface.kind == "GroundSurface")
                .map(|(index, _)| index)
                .collect();
            (ground, &semantics.values)
        });
        let grounds = grounds.filter(|(ground, _)| !ground.is_empty());
        collect_surfaces(
            &geometry.boundaries,
            grounds.as_ref().map(|(g, v)| (g, *v)),
            city,
            &mut surfaces,
        );
    }
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for point in surfaces.iter().flat_map(|surface| surface.rings.iter().flatten()) {
        low = low.min(point.z);
        high = high.max(point.z);
    }
    // The ground as the semantics or the normals tell; a model without a floor is covered by its roofs.
    let has_floor = |surface: &&Surface| {
        surface
            .is_ground
            .unwrap_or_else(|| lean(&surface.rings[0]) < -0.7)
    };
    let mut grounds = plans(surfaces.iter().filter(has_floor));
    if grounds.is_empty() {
        grounds = plans(
            surfaces
                .iter()
                .filter(|surface| lean(&surface.rings[0]).abs() > 0.05),
        );
    }
    let vertices: usize = grounds.iter().map(CoordsIter::coords_count).sum();
    if grounds.is_empty() || (grounds.len() > 1 && vertices > MAX_JOINED) {
        return None;
    }
    let plan = if grounds.len() == 1 {
        MultiPolygon::new(grounds)
    } else {
        unary_union(&grounds)
    };
    (!plan.0.is_empty()).then_some((plan, [low, high]))
}

struct Surface {
    rings: Vec<Vec<DVec3>>,
    /// What the semantics say, none where the file has none.
    is_ground: Option<bool>,
}

/// Walks boundaries of any depth (MultiSurface, Solid, MultiSolid) down to surfaces: lists of rings.
fn collect_surfaces(
    boundaries: &Value,
    grounds: Option<(&BTreeSet<u64>, &Value)>,
    city: &CityJson,
    surfaces: &mut Vec<Surface>,
) {
    let Some(members) = boundaries.as_array() else {
        return;
    };
    let is_ring_list = members
        .first()
        .and_then(|ring| ring.as_array()?.first())
        .is_some_and(Value::is_number);
    if is_ring_list {
        let rings: Vec<Vec<DVec3>> = members
            .iter()
            .filter_map(|ring| ring.as_array())
            .map(|ring| ring.iter().filter_map(|index| vertex(index, city)).collect())
            .collect();
        if rings.first().is_some_and(|ring: &Vec<DVec3>| ring.len() >= 3) {
            let is_ground =
                grounds.map(|(ground, values)| values.as_u64().is_some_and(|value| ground.contains(&value)));
            surfaces.push(Surface { rings, is_ground });
        }
        return;
    }
    for (index, member) in members.iter().enumerate() {
        let below = grounds.map(|(ground, values)| (ground, values.get(index).unwrap_or(&Value::Null)));
        collect_surfaces(member, below, city, surfaces);
    }
}

fn vertex(index: &Value, city: &CityJson) -> Option<DVec3> {
    let stored = DVec3::from_array(*city.vertices.get(index.as_u64()? as usize)?);
    Some(match &city.transform {
        Some(quantisation) => {
            stored * DVec3::from_array(quantisation.scale) + DVec3::from_array(quantisation.translate)
        }
        None => stored,
    })
}

/// The surfaces seen from above, those that are valid polygons.
fn plans<'a>(surfaces: impl Iterator<Item = &'a Surface>) -> Vec<Polygon<f64>> {
    surfaces
        .filter_map(|surface| {
            let mut rings = surface
                .rings
                .iter()
                .map(|ring| LineString::new(ring.iter().map(|p| Coord { x: p.x, y: p.y }).collect()));
            let polygon = Polygon::new(rings.next()?, rings.collect());
            is_valid(&MultiPolygon::from(polygon.clone())).then_some(polygon)
        })
        .collect()
}

/// Height of the ring's unit normal (Newell): -1 faces down, 0 stands upright, 1 faces up.
fn lean(ring: &[DVec3]) -> f64 {
    let mut normal = DVec3::ZERO;
    for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        normal += (a - ring[0]).cross(b - ring[0]);
    }
    normal.normalize_or_zero().z
}
