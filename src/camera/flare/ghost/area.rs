//! How much drawing a mesh costs.

use geo::{Area, BooleanOps, BoundingRect, Rect, Triangle, coord};

use super::FlareVertex;

/// Area of triangles on a film that spans `half_mm` to each side, overlaps counted, square millimetres: the raster work.
pub fn area_on_film(vertices: &[FlareVertex], half_mm: [f64; 2]) -> f64 {
    let [x, y] = half_mm;
    let film = Rect::new(coord! { x: -x, y: -y }, coord! { x: x, y: y });
    vertices
        .chunks_exact(3)
        .map(|triangle_vertices| {
            let at = |k: usize| {
                let [x, y] = triangle_vertices[k].sensor_mm.map(f64::from);
                coord! { x: x, y: y }
            };
            let triangle = Triangle::new(at(0), at(1), at(2));
            let bounds = triangle.bounding_rect();
            let is_apart =
                bounds.min().x > x || bounds.max().x < -x || bounds.min().y > y || bounds.max().y < -y;
            if is_apart {
                return 0.0;
            }
            triangle
                .to_polygon()
                .intersection(&film.to_polygon())
                .unsigned_area()
        })
        .sum()
}
