//! Repairs outlines: duplicate points, unclosed and self-crossing rings, zero area, orientation.

use gdal::vector::{Geometry, OGRwkbGeometryType};
use geo::{
    Area, BoundingRect, Coord, LineString, MultiPolygon, Orient, Polygon, Validation, orient::Direction,
};

use super::outline::Outline;

/// What cleaning did to one outline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CleanReport {
    /// Points closer than a millimetre were merged.
    pub merged_points: bool,
    /// An open polyline was closed.
    pub closed: bool,
    /// A self-crossing or otherwise invalid outline was rebuilt (GEOS MakeValid).
    pub rebuilt: bool,
    /// A ring without area was dropped.
    pub dropped_rings: bool,
}

/// Points closer than this are one point, metres.
const SAME_POINT_M: f64 = 1e-3;

/// Smaller rings are no building, square metres.
const MIN_AREA_M2: f64 = 0.01;

/// The cleaned outline, outer rings counter-clockwise, or why there is none.
pub fn clean_outline(outline: &Outline) -> Result<(MultiPolygon<f64>, CleanReport), &'static str> {
    let mut report = CleanReport {
        closed: outline.closed_by_us,
        ..CleanReport::default()
    };
    let mut polygons = Vec::new();
    for rings in &outline.polygons {
        let mut cleaned = Vec::new();
        for (index, ring) in rings.iter().enumerate() {
            if ring
                .iter()
                .any(|point| !point.x.is_finite() || !point.y.is_finite())
            {
                return Err("outside the area of the coordinate reference system");
            }
            let (ring, merged) = without_repeats(ring);
            report.merged_points |= merged;
            if ring.len() < 3 {
                report.dropped_rings = true;
                if index == 0 {
                    break; // holes of nothing
                }
                continue;
            }
            cleaned.push(LineString::new(ring));
        }
        if !cleaned.is_empty() {
            let exterior = cleaned.remove(0);
            polygons.push(Polygon::new(exterior, cleaned));
        }
    }
    let mut multi = MultiPolygon::new(polygons);
    if multi.0.is_empty() {
        return Err("an outline of fewer than three different points");
    }
    if !is_valid(&multi) {
        if is_tangled(&multi) {
            return Err("an outline too tangled to repair");
        }
        multi = make_valid(&multi).ok_or("an outline beyond repair")?;
        report.rebuilt = true;
    }
    let parts = multi.0.len();
    multi.0.retain(|polygon| polygon.unsigned_area() >= MIN_AREA_M2);
    report.dropped_rings |= multi.0.len() < parts;
    if multi.0.is_empty() {
        return Err("an outline without area");
    }
    let extent = multi.bounding_rect();
    if extent.is_some_and(|extent| extent.width().max(extent.height()) > MAX_EXTENT_M) {
        return Err("wider than 50 km: broken coordinates, or no building");
    }
    Ok((multi.orient(Direction::Default), report))
}

/// Widest believable building, metres.
const MAX_EXTENT_M: f64 = 50_000.0;

/// Outlines beyond this are tested by GEOS, whose cost does not grow with the square of the vertices.
const MANY_VERTICES: usize = 1000;

/// Outlines that cross themselves more often are no outlines, and repairing them would not end.
const MAX_CROSSINGS: usize = 1000;

fn vertex_count(multi: &MultiPolygon<f64>) -> usize {
    use geo::CoordsIter;
    multi.coords_count()
}

/// Whether an outline is a valid one (OGC 06-103r4, 6.1.11), in time that does not grow with the square of its vertices.
pub fn is_valid(multi: &MultiPolygon<f64>) -> bool {
    match vertex_count(multi) > MANY_VERTICES {
        true => geos_valid(multi),
        false => multi.is_valid(),
    }
}

fn geos_valid(multi: &MultiPolygon<f64>) -> bool {
    Geometry::from_wkb(&super::feature::wkb_of(multi)).is_ok_and(|geometry| geometry.is_valid())
}

/// True when edges cross more often than can be repaired, or there are too many edges to tell.
fn is_tangled(multi: &MultiPolygon<f64>) -> bool {
    use geo::{Intersects, LinesIter};
    use rstar::RTreeObject;
    let tree = rstar::RTree::bulk_load(multi.lines_iter().collect());
    if tree.size() > MAX_TESTED {
        return true;
    }
    // Each pair twice, each line with itself, and neighbours, which meet once.
    let most = 2 * MAX_CROSSINGS + 3 * tree.size();
    let (mut meetings, mut tests) = (0, 0);
    for line in &tree {
        for other in tree.locate_in_envelope_intersecting(&line.envelope()) {
            tests += 1;
            meetings += usize::from(line.intersects(other));
        }
        if meetings > most || tests > MAX_TESTS {
            return true;
        }
    }
    false
}

/// Edges that are tested for crossings, and how many tests that may take.
const MAX_TESTED: usize = 30_000;
const MAX_TESTS: usize = 20_000_000;

/// Drops repeated points and the closing one. True when a real repeat was dropped.
fn without_repeats(ring: &[Coord<f64>]) -> (Vec<Coord<f64>>, bool) {
    let same =
        |a: &Coord<f64>, b: &Coord<f64>| (a.x - b.x).abs() < SAME_POINT_M && (a.y - b.y).abs() < SAME_POINT_M;
    let closed = ring.len() > 1 && ring.first() == ring.last();
    let open = &ring[..ring.len() - usize::from(closed)];
    let mut points: Vec<Coord<f64>> = Vec::with_capacity(open.len());
    for point in open {
        if points.last().is_none_or(|last| !same(last, point)) {
            points.push(*point);
        }
    }
    while points.len() > 1 && same(&points[0], &points[points.len() - 1]) {
        points.pop();
    }
    let merged = points.len() < open.len();
    (points, merged)
}

fn make_valid(multi: &MultiPolygon<f64>) -> Option<MultiPolygon<f64>> {
    let geometry = Geometry::from_wkb(&super::feature::wkb_of(multi)).ok()?;
    let valid = geometry.make_valid(&gdal::cpl::CslStringList::new()).ok()?;
    let mut outline = Outline::default();
    super::feature::collect_polygons(&valid, &mut outline, OGRwkbGeometryType::wkbPolygon);
    let polygons = outline
        .polygons
        .into_iter()
        .map(|mut rings| {
            let exterior = LineString::new(rings.remove(0));
            Polygon::new(exterior, rings.into_iter().map(LineString::new).collect())
        })
        .collect();
    Some(MultiPolygon::new(polygons))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn outline(ring: &[(f64, f64)]) -> Outline {
        Outline {
            polygons: vec![vec![ring.iter().map(|&(x, y)| Coord { x, y }).collect()]],
            closed_by_us: false,
        }
    }

    #[test]
    fn a_clockwise_square_with_repeats_becomes_counter_clockwise() {
        let square = outline(&[(0., 0.), (0., 2.), (0., 2.), (2., 2.), (2., 0.), (0., 0.)]);
        let (multi, report) = clean_outline(&square).unwrap();
        assert!(report.merged_points && !report.rebuilt);
        assert_eq!(multi.signed_area(), 4.0);
    }

    #[test]
    fn a_bow_tie_becomes_its_two_lobes() {
        let bow = outline(&[(0., 0.), (2., 2.), (2., 0.), (0., 2.)]);
        let (multi, report) = clean_outline(&bow).unwrap();
        assert!(report.rebuilt);
        assert_eq!(multi.0.len(), 2);
        assert!((multi.unsigned_area() - 2.0).abs() < 1e-9);
    }

    #[test]
    fn two_points_and_flat_rings_are_refused() {
        assert!(clean_outline(&outline(&[(0., 0.), (1., 1.), (0., 0.)])).is_err());
        assert!(clean_outline(&outline(&[(0., 0.), (1., 0.), (2., 0.)])).is_err());
        assert!(clean_outline(&outline(&[(0., 0.), (1e12, 0.), (0., 1e12)])).is_err());
        assert!(clean_outline(&outline(&[(0., 0.), (f64::NAN, 0.), (2., 0.)])).is_err());
    }
}
