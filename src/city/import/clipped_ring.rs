//! The part of a ring inside a rectangle, so that a long coast costs a tile only what lies on it.

use geo::Coord;

use crate::space::Bounds;

/// A ring cut to a rectangle, side by side (I. Sutherland, G. Hodgman, "Reentrant polygon clipping", CACM 17, 1974). Where it leaves
/// the rectangle it runs along its sides, and may run there twice: its area is the ring's, its outline is not.
pub fn clipped_ring(ring: &[Coord<f64>], bounds: &Bounds) -> Vec<Coord<f64>> {
    // Signed distances inwards of each side.
    let sides: [&dyn Fn(Coord<f64>) -> f64; 4] = [
        &|at| at.x - bounds.west,
        &|at| bounds.east - at.x,
        &|at| at.y - bounds.south,
        &|at| bounds.north - at.y,
    ];
    let mut points = ring.to_vec();
    for inwards in sides {
        let mut kept = Vec::new();
        for (index, &to) in points.iter().enumerate() {
            let from = points[(index + points.len() - 1) % points.len()];
            let (before, after) = (inwards(from), inwards(to));
            if (before < 0.0) != (after < 0.0) {
                kept.push(from + (to - from) * (before / (before - after)));
            }
            if after >= 0.0 {
                kept.push(to);
            }
        }
        points = kept;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use geo::{Area, LineString, Polygon};

    #[test]
    fn the_area_is_the_part_inside() {
        let bounds = Bounds {
            west: 0.0,
            south: 0.0,
            east: 10.0,
            north: 10.0,
        };
        // A comb whose teeth reach in from the east.
        let mut comb = vec![Coord { x: 20.0, y: 12.0 }, Coord { x: 20.0, y: 0.0 }];
        for tooth in 0..5 {
            let y = 2.0 * f64::from(tooth);
            comb.extend(
                [(5.0, y), (5.0, y + 1.0), (15.0, y + 1.0), (15.0, y + 2.0)].map(|(x, y)| Coord { x, y }),
            );
        }
        let area = |ring: Vec<Coord<f64>>| Polygon::new(LineString::new(ring), Vec::new()).unsigned_area();
        assert!((area(clipped_ring(&comb, &bounds)) - 25.0).abs() < 1e-9);
        assert!(clipped_ring(&comb, &Bounds { east: 4.0, ..bounds }).is_empty());
    }
}
