//! A ghost's image divided by how its parts are softened: its folds, much brighter than the rest, apart; what is shut left out.

use glam::DVec2;

use super::ghost_triangles::{GhostTriangles, triangle_area_mm2, triangle_light};
use super::linear::MAX_SOFTNESS;
use super::nonlinear_images::GhostImage;
use super::softness::Softness;
use super::vertex::FlareVertex;

/// Triangles of a ghost's image that are softened alike.
pub struct Layer {
    /// What is known of them.
    pub triangles: GhostTriangles,
    /// Three a triangle.
    pub vertices: Vec<FlareVertex>,
}

/// Those of an image in so many colours: its folds apart.
pub fn layers(image: GhostImage, colours: usize) -> impl Iterator<Item = Layer> {
    let GhostImage {
        softness,
        vertices,
        lit_mm2,
    } = image;
    let vertices = open_triangles(&vertices, &softness);
    let is_blurred = softness.stop > MAX_SOFTNESS || softness.front > MAX_SOFTNESS;
    let light: f64 = vertices.chunks_exact(3).map(triangle_light).sum();
    let (folds, rest) = folded(vertices);
    let in_folds: f64 = folds.chunks_exact(3).map(triangle_light).sum();
    // More an image of the light than of the iris, or too unlike one.
    let is_blurred = is_blurred || in_folds > MAX_IN_FOLDS * light;
    let rest = if is_blurred {
        widened(rest, WIDENED * softness.edge_mm)
    } else {
        rest
    };
    let in_iris = (!is_blurred).then_some([softness.stop, softness.front]);
    let folds = widened(folds, WIDENED * softness.fold_mm);
    [(rest, softness.edge_mm, in_iris), (folds, softness.fold_mm, None)]
        .into_iter()
        .filter(|(vertices, ..)| !vertices.is_empty())
        .map(move |(vertices, radius_mm, in_iris)| Layer {
            triangles: GhostTriangles::new(&vertices, (colours, lit_mm2), radius_mm, in_iris),
            vertices,
        })
}

/// How far beyond the edges of iris and barrel, in their radii, light still falls on a pixel: more than one pixel holds.
const EDGE: f64 = 0.05;

/// Triangles of which iris and barrel, softened as they are, let something through.
fn open_triangles(vertices: &[FlareVertex], softness: &Softness) -> Vec<FlareVertex> {
    let is_reached = |triangle: &[FlareVertex], of: fn(&FlareVertex) -> [f32; 2], softness: f64| {
        let corners = [0, 1, 2].map(|k: usize| glam::Vec2::from_array(of(&triangle[k])).as_dvec2());
        let reach = 1.0 + softness.min(MAX_SOFTNESS) + EDGE;
        // Written so that what is no number is drawn.
        let is_beside = (0..3).any(|k| {
            let (a, b, c) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let normal = (b - a).perp().normalize_or_zero();
            let [edge, other] = [normal.dot(a), normal.dot(c)];
            // The centre lies beyond an edge, farther than it reaches.
            (edge > reach && other > edge) || (edge < -reach && other < edge)
        });
        !is_beside
    };
    let is_open = |triangle: &&[FlareVertex]| {
        is_reached(triangle, |vertex| vertex.stop, softness.stop)
            && is_reached(triangle, |vertex| vertex.barrel, softness.front)
    };
    vertices
        .chunks_exact(3)
        .filter(is_open)
        .collect::<Vec<_>>()
        .concat()
}

/// Fraction of a ghost's light in its folds up to which it is softened as an image of the iris.
const MAX_IN_FOLDS: f64 = 0.12;

/// Radiance of a ghost's folds, at least, by its mean.
const FOLD_RADIANCE: f64 = 4.0;

/// Triangles of a ghost that are much brighter than its mean, and the others.
fn folded(vertices: Vec<FlareVertex>) -> (Vec<FlareVertex>, Vec<FlareVertex>) {
    let triangles = || vertices.chunks_exact(3);
    let area: f64 = triangles().map(triangle_area_mm2).sum();
    let bright = FOLD_RADIANCE * triangles().map(triangle_light).sum::<f64>() / area;
    let (folds, rest): (Vec<&[FlareVertex]>, Vec<&[FlareVertex]>) =
        triangles().partition(|triangle| triangle_light(triangle) > bright * triangle_area_mm2(triangle));
    (folds.concat(), rest.concat())
}

/// Least width of the triangles that are softened on the sensor, by the radius: a texel of those that they are drawn on.
const WIDENED: f64 = 0.2;

/// Triangles no narrower than `min_mm`, each with the light that it had: folds lay much light on slivers that fall between texels.
fn widened(mut vertices: Vec<FlareVertex>, min_mm: f64) -> Vec<FlareVertex> {
    for triangle in vertices.chunks_exact_mut(3) {
        let at = [0, 1, 2].map(|k: usize| glam::Vec2::from_array(triangle[k].sensor_mm).as_dvec2());
        let edges = [at[1] - at[0], at[2] - at[1], at[0] - at[2]];
        let longest = edges.into_iter().fold(DVec2::ZERO, |longest, edge| {
            if edge.length() > longest.length() {
                edge
            } else {
                longest
            }
        });
        let area = 0.5 * edges[0].perp_dot(edges[1]).abs();
        let height = 2.0 * area / longest.length().max(1e-12);
        if height >= min_mm || area == 0.0 {
            continue;
        }
        let along = longest.normalize_or(DVec2::X);
        let scale = DVec2::new((min_mm / longest.length()).max(1.0), min_mm / height);
        let centre = (at[0] + at[1] + at[2]) / 3.0;
        for (vertex, at) in triangle.iter_mut().zip(at) {
            let from_centre = DVec2::new(along.x, -along.y).rotate(at - centre) * scale;
            vertex.sensor_mm = (centre + along.rotate(from_centre)).as_vec2().to_array();
            vertex.radiance = vertex
                .radiance
                .map(|channel| channel / (scale.x * scale.y) as f32);
        }
    }
    vertices
}
