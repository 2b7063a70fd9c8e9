//! Rings between a file and their cleaning.

use geo::Coord;

/// Rings as a file gave them: per polygon an outer ring and its holes. Points are metres in the city's CRS.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// Polygons, each a list of rings, the outer one first.
    pub polygons: Vec<Vec<Vec<Coord<f64>>>>,
    /// True when an open polyline had to be taken as a ring.
    pub closed_by_us: bool,
}
