//! One OGR feature: its rings, its WKB and its height field.

use gdal::vector::{Feature, Geometry, OGRwkbGeometryType, geometry_type_flatten};
use geo::{Coord, MultiPolygon};

use super::outline::Outline;

/// Adds every area of a geometry to the outline: polygons as they are; lines, when `accept` is `wkbLineString`,
/// as rings (CAD files draw buildings as closed or almost closed polylines).
pub fn collect_polygons(geometry: &Geometry, outline: &mut Outline, accept: OGRwkbGeometryType::Type) {
    let linear = linearised(geometry);
    let geometry = linear.as_ref().unwrap_or(geometry);
    match geometry_type_flatten(geometry.geometry_type()) {
        OGRwkbGeometryType::wkbPolygon | OGRwkbGeometryType::wkbTriangle => {
            let rings: Vec<_> = (0..geometry.geometry_count())
                .map(|index| points(&geometry.get_geometry(index)))
                .collect();
            if !rings.is_empty() {
                outline.polygons.push(rings);
            }
        }
        OGRwkbGeometryType::wkbLineString if accept == OGRwkbGeometryType::wkbLineString => {
            let ring = points(geometry);
            if ring.len() >= 3 {
                outline.closed_by_us |= ring.first() != ring.last();
                outline.polygons.push(vec![ring]);
            }
        }
        _ => {
            for index in 0..geometry.geometry_count() {
                collect_polygons(&geometry.get_geometry(index), outline, accept);
            }
        }
    }
}

/// Curves as chords, by OGR; none when there are no curves.
pub(super) fn linearised(geometry: &Geometry) -> Option<Geometry> {
    // SAFETY: the handle is alive; the clone that OGR returns is owned by the new geometry.
    unsafe {
        if gdal_sys::OGR_G_HasCurveGeometry(geometry.c_geometry(), 0) == 0 {
            return None;
        }
        let linear = gdal_sys::OGR_G_GetLinearGeometry(geometry.c_geometry(), 0.0, std::ptr::null_mut());
        if linear.is_null() {
            return None;
        }
        let owned = Geometry::lazy_feature_geometry();
        owned.set_c_geometry(linear);
        let copy = owned.clone();
        gdal_sys::OGR_G_DestroyGeometry(linear);
        Some(copy)
    }
}

fn points(ring: &Geometry) -> Vec<Coord<f64>> {
    let mut points = Vec::new();
    ring.get_points(&mut points);
    points.iter().map(|&(x, y, _)| Coord { x, y }).collect()
}

/// Well-known binary of a multipolygon (OGC 06-103r4, section 8.2), little endian.
pub fn wkb_of(multi: &MultiPolygon<f64>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let header = |bytes: &mut Vec<u8>, kind: u32, count: usize| {
        bytes.push(1);
        bytes.extend(kind.to_le_bytes());
        bytes.extend((count as u32).to_le_bytes());
    };
    header(&mut bytes, 6, multi.0.len());
    for polygon in multi {
        header(&mut bytes, 3, 1 + polygon.interiors().len());
        for ring in std::iter::once(polygon.exterior()).chain(polygon.interiors()) {
            bytes.extend((ring.0.len() as u32).to_le_bytes());
            for point in &ring.0 {
                bytes.extend(point.x.to_le_bytes());
                bytes.extend(point.y.to_le_bytes());
            }
        }
    }
    bytes
}

/// Where a named attribute is found in a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldPlace {
    /// A column of its own.
    Column(usize),
    /// A key of the OSM driver's `other_tags` column.
    OtherTags(usize),
}

impl FieldPlace {
    /// The attribute's text, none when null or absent.
    pub fn text(self, feature: &Feature<'_>, key: &str) -> Option<String> {
        let text = |index: usize| column_text(feature, index);
        match self {
            Self::Column(index) => text(index),
            Self::OtherTags(index) => tag_of(&text(index)?, key),
        }
    }
}

/// A column's text; none when it is null, unset or empty.
pub fn column_text(feature: &Feature<'_>, index: usize) -> Option<String> {
    let text = feature.field_as_string(index).ok().flatten();
    text.filter(|text| !text.trim().is_empty())
}

/// The value of `key` in the OSM driver's text `"key"=>"value","key"=>"value"`.
fn tag_of(tags: &str, key: &str) -> Option<String> {
    let start = tags.find(&format!("\"{key}\"=>\""))? + key.len() + 5;
    let rest = tags.get(start..)?;
    let mut value = String::new();
    let mut characters = rest.chars();
    while let Some(character) = characters.next() {
        match character {
            '"' => return Some(value),
            '\\' => value.extend(characters.next()),
            other => value.push(other),
        }
    }
    None
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn osm_tags_are_found_by_key() {
        let tags = r#""name"=>"A \"B\"","building:levels"=>"5","height"=>"12.5 m""#;
        assert_eq!(tag_of(tags, "building:levels").as_deref(), Some("5"));
        assert_eq!(tag_of(tags, "height").as_deref(), Some("12.5 m"));
        assert_eq!(tag_of(tags, "name").as_deref(), Some("A \"B\""));
        assert_eq!(tag_of(tags, "levels"), None);
    }

    #[test]
    fn wkb_is_what_ogr_reads() {
        use geo::{Area, polygon};
        let multi = MultiPolygon::new(vec![polygon!(
            exterior: [(x: 0., y: 0.), (x: 4., y: 0.), (x: 4., y: 4.), (x: 0., y: 4.)],
            interiors: [[(x: 1., y: 1.), (x: 1., y: 2.), (x: 2., y: 2.), (x: 2., y: 1.)]]
        )]);
        let geometry = Geometry::from_wkb(&wkb_of(&multi)).unwrap();
        assert!((geometry.area() - multi.unsigned_area()).abs() < 1e-12);
    }
}
