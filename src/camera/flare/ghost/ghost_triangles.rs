//! What is known of the triangles of one image of a ghost.

use glam::DVec2;

use super::coverage::Coverage;
use super::vertex::FlareVertex;

/// Triangles of one image of a ghost.
#[derive(Clone, Debug, PartialEq)]
pub struct GhostTriangles {
    /// Number of vertices.
    pub vertices: usize,
    /// Radius of the disc that each of its points becomes, millimetres.
    pub radius_mm: f64,
    /// Where it becomes that: radii in the iris and on the front, in their own; none for on the sensor.
    pub in_iris: Option<[f64; 2]>,
    /// Least and greatest coordinates on the sensor, millimetres.
    pub bounds_mm: [DVec2; 2],
    /// Where its triangles lie, of one that is softened on the sensor.
    pub coverage: Option<Coverage>,
    /// Area that it covers in each colour, square millimetres: what a round iris and the barrel let through.
    pub area_mm2: f64,
    /// Radiance by that area, all channels: square millimetres for a light of irradiance 1.
    pub light: f64,
}

impl GhostTriangles {
    /// Of triangles in so many colours, with the lit area where it is known otherwise.
    pub fn new(
        vertices: &[FlareVertex],
        (colours, lit_mm2): (usize, Option<f64>),
        radius_mm: f64,
        in_iris: Option<[f64; 2]>,
    ) -> Self {
        let at = |vertex: &FlareVertex| glam::Vec2::from_array(vertex.sensor_mm).as_dvec2();
        let empty = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let (mut area_mm2, mut light) = (0.0, 0.0);
        for triangle in vertices.chunks_exact(3) {
            let whole = triangle_area_mm2(triangle);
            let lit = match lit_mm2 {
                // Quads are two triangles.
                Some(lit_mm2) => 0.5 * lit_mm2,
                None if is_lit(triangle) => whole,
                None => 0.0,
            };
            area_mm2 += lit / colours as f64;
            light += triangle_light(triangle) * lit / whole.max(1e-12);
        }
        let bounds_mm = vertices
            .iter()
            .map(at)
            .fold(empty, |[min, max], at| [min.min(at), max.max(at)]);
        Self {
            vertices: vertices.len(),
            radius_mm,
            in_iris,
            bounds_mm,
            coverage: in_iris.is_none().then(|| Coverage::new(vertices, bounds_mm)),
            area_mm2,
            light,
        }
    }
}

/// Whether iris and barrel let the centre of a triangle through.
fn is_lit(triangle: &[FlareVertex]) -> bool {
    let centre = |of: fn(&FlareVertex) -> [f32; 2]| {
        let sum: glam::Vec2 = triangle
            .iter()
            .map(|vertex| glam::Vec2::from_array(of(vertex)))
            .sum();
        sum / 3.0
    };
    centre(|vertex| vertex.stop).length() <= 1.0 && centre(|vertex| vertex.barrel).length() <= 1.0
}

/// Radiance of a triangle, all channels, by its area.
pub fn triangle_light(triangle: &[FlareVertex]) -> f64 {
    let radiance = triangle
        .iter()
        .flat_map(|vertex| vertex.radiance)
        .map(f64::from)
        .sum::<f64>()
        / 3.0;
    radiance * triangle_area_mm2(triangle)
}

/// Area of a triangle on the sensor, square millimetres.
pub fn triangle_area_mm2(triangle: &[FlareVertex]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k: usize| glam::Vec2::from_array(triangle[k].sensor_mm).as_dvec2());
    0.5 * (b - a).perp_dot(c - a).abs()
}
