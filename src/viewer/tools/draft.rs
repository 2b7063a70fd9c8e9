//! A footprint in the drawing.

use geo::{Coord, LineString, MultiPolygon, Polygon};
use glam::DVec3;

/// Vertices so far, on the ground.
#[derive(Clone, Debug)]
pub struct Draft {
    /// Vertices, metres in the city's CRS.
    pub points: Vec<DVec3>,
    /// Height that the building is to have, metres.
    pub height_m: f64,
}

/// Height that a new building has until it is told another, metres.
const FIRST_HEIGHT_M: f64 = 9.0;

impl Default for Draft {
    fn default() -> Self {
        Self {
            points: Vec::new(),
            height_m: FIRST_HEIGHT_M,
        }
    }
}

impl Draft {
    /// The outline; none before it has three vertices.
    pub fn outline(&self) -> Option<MultiPolygon<f64>> {
        if self.points.len() < 3 {
            return None;
        }
        let ring: Vec<Coord<f64>> = (self.points.iter())
            .map(|point| Coord {
                x: point.x,
                y: point.y,
            })
            .collect();
        Some(MultiPolygon::new(vec![Polygon::new(
            LineString::new(ring),
            Vec::new(),
        )]))
    }
}
