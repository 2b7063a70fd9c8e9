//! Ghosts as triangles on the sensor, each vertex knowing where its ray crossed the stop and the lens barrel.
//!
//! - **paraxial**: four entrance points a ghost and wavelength, carried by the matrices (KR 10-1465658; Lee & Eisemann
//!   2013, section 4): one flare quad. **two rays**: the same from two points.
//! - **exact**: a grid of rays over the entrance, traced surface by surface (Hullin et al. 2011).
//! - **blended**: quads where ghosts are nearly linear, grids where they are not, traced or out of a table
//!   (KR 10-1658883).
//!
//! Energy: a beam of irradiance E at an angle a gives the entrance E · cos a, and arrives as E · cos a · power · |entrance area /
//! sensor area|. A scene of radiance L gives the sensor π L / (4 N²) at f-number N, so that a ghost adds the radiance
//! E · cos a · power · areas · 4 N² / π.

use glam::DVec2;
use rayon::prelude::*;

use super::blend::{Blend, fractions};
use super::coverage::Coverage;
use super::linear::{LinearGhost, MAX_SOFTNESS, stop_radius};
use super::nonlinear_images::{Context, GhostImage, Optics, Part};
use super::nonlinearity::nonlinearity;
use super::parameters::{FlareMode, FlareParameters, Pattern};
use super::quad::{quad, two_rays};
use super::softness::Softness;
use super::vertex::FlareVertex;
use crate::camera::flare::spectrum;
use crate::camera::lens::D_LINE_UM;
use crate::camera::paraxial::Paraxial;
use crate::camera::path::single_crossing_ghosts;
use crate::camera::trace::Tracer;
use crate::gpu::GpuError;

/// Triangles, three vertices each.
#[derive(Clone, Debug, Default)]
pub struct FlareMesh {
    /// Ghosts that add up.
    pub added: Vec<FlareVertex>,
    /// Which of those belong together, in their order.
    pub ghosts: Vec<GhostTriangles>,
    /// What hides those, without light of its own.
    pub masks: Vec<FlareVertex>,
    /// Ghosts that add to what is left.
    pub above: Vec<FlareVertex>,
}

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
    fn new(
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

impl FlareMesh {
    /// Adds images of ghosts, each in so many colours.
    fn add(&mut self, images: Vec<GhostImage>, colours: usize) {
        let layers: Vec<Layer> = images
            .into_par_iter()
            .flat_map_iter(|image| layers(image, colours))
            .collect();
        self.added
            .reserve(layers.iter().map(|layer| layer.vertices.len()).sum());
        for layer in layers {
            self.added.extend_from_slice(&layer.vertices);
            self.ghosts.push(layer.triangles);
        }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        (self.added.len() + self.masks.len() + self.above.len()) / 3
    }

    /// Area of all triangles, also beside the film, square millimetres.
    pub fn area_mm2(&self) -> f64 {
        let parts = [&self.added, &self.masks, &self.above];
        let triangles = parts
            .into_par_iter()
            .flat_map(|vertices| vertices.par_chunks_exact(3));
        triangles.map(triangle_area_mm2).sum()
    }
}

/// Triangles of a ghost's image that are softened alike.
struct Layer {
    triangles: GhostTriangles,
    vertices: Vec<FlareVertex>,
}

/// Those of an image in so many colours: its folds apart.
fn layers(image: GhostImage, colours: usize) -> impl Iterator<Item = Layer> {
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

/// Radiance of a triangle, all channels, by its area.
fn triangle_light(triangle: &[FlareVertex]) -> f64 {
    let radiance = triangle
        .iter()
        .flat_map(|vertex| vertex.radiance)
        .map(f64::from)
        .sum::<f64>()
        / 3.0;
    radiance * triangle_area_mm2(triangle)
}

fn triangle_area_mm2(triangle: &[FlareVertex]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k: usize| glam::Vec2::from_array(triangle[k].sensor_mm).as_dvec2());
    0.5 * (b - a).perp_dot(c - a).abs()
}

/// Triangles of a flare.
pub fn flare_mesh(parameters: &FlareParameters<'_>) -> Result<FlareMesh, GpuError> {
    let FlareParameters {
        lens, source, ghosts, ..
    } = *parameters;
    // The sensor stays in the focus of the d line for every colour. So is the iris set.
    let d_line = Paraxial::new(lens, D_LINE_UM, None);
    let gap = d_line.sensor_gap_mm();
    let stop_mm = stop_radius(lens, &d_line, source.f_number);
    let optics: Vec<Optics> = spectrum(ghosts.wavelengths)
        .into_iter()
        .map(|colour| Optics {
            colour,
            paraxial: Paraxial::new(lens, colour.um, Some(gap)),
        })
        .collect();
    let parts = parts(parameters);
    let linear_of =
        |ghost, paraxial: &Paraxial| LinearGhost::new(lens, paraxial, ghost, source.angle, stop_mm);

    let mut mesh = FlareMesh::default();
    let quads = parts.par_iter().filter(|part| part.linear > 0.0);
    let quads_of = |part: &Part| {
        let linear = linear_of(part.ghost, &d_line);
        let softness = Softness::linear(&linear, &source);
        // A round iris fills that much of its square.
        let lit_mm2 = linear.f[0].powi(2) * std::f64::consts::PI * linear.half.element_product();
        let vertices = optics.iter().flat_map(|optics| {
            let tracer = Tracer::new(lens, optics.colour.um, gap);
            let linear = linear_of(part.ghost, &optics.paraxial).softened(&softness);
            let linear = if ghosts.whole_entrance {
                linear.with_whole_entrance()
            } else {
                linear
            };
            let draw = match ghosts.mode {
                FlareMode::TwoRays => two_rays,
                _ => quad,
            };
            let mut vertices = draw(&tracer, &linear, optics.colour, &source, part.ghost);
            for vertex in &mut vertices {
                vertex.radiance = vertex.radiance.map(|channel| channel * part.linear as f32);
            }
            vertices
        });
        GhostImage {
            softness,
            vertices: vertices.collect(),
            lit_mm2: Some(lit_mm2),
        }
    };
    mesh.add(quads.map(quads_of).collect(), optics.len());

    let curved: Vec<&Part> = parts.iter().filter(|part| part.nonlinear > 0.0).collect();
    let context = Context {
        parameters,
        optics: &optics,
        d_line: &d_line,
        stop_mm,
    };
    let images = match (ghosts.mode, parameters.table) {
        (FlareMode::Blended, Some(table)) => {
            let (traced, tabled): (Vec<&Part>, Vec<&Part>) =
                curved.iter().partition(|part| table.is_traced(part.ghost));
            let mut images = context.tabled(&tabled, table);
            // No grid of a table tells them, as thin as they are.
            images.extend(context.traced(&traced, 2)?);
            images
        }
        _ => context.traced(&curved, 1)?,
    };
    if ghosts.mode != FlareMode::Blended || ghosts.blend != Blend::Alpha {
        mesh.add(images, optics.len());
        return Ok(mesh);
    }
    mesh.above = images.into_iter().flat_map(|image| image.vertices).collect();
    // One colour masks for all: each would hide the others.
    let masks = mesh.above.iter().filter(|vertex| vertex.opacity > 0.0);
    mesh.masks = masks
        .map(|vertex| FlareVertex {
            radiance: [0.0; 3],
            ..*vertex
        })
        .collect();
    Ok(mesh)
}

/// Which images of which ghosts are drawn.
fn parts(parameters: &FlareParameters<'_>) -> Vec<Part> {
    let FlareParameters {
        lens,
        source,
        ghosts: asked,
        ..
    } = *parameters;
    let ghosts = match asked.only {
        Some(ghost) => vec![ghost],
        None => single_crossing_ghosts(lens),
    };
    ghosts
        .into_par_iter()
        .map(|ghost| {
            // Beside a table of images, ghosts are divided as they were when it was drawn.
            let (mode, blend) = match asked.pattern {
                Pattern::Whole => (asked.mode, asked.blend),
                _ => (FlareMode::Blended, Blend::Add),
            };
            let [linear, nonlinear] = match (mode, parameters.table) {
                (FlareMode::Paraxial | FlareMode::TwoRays, _) => [1.0, 0.0],
                (FlareMode::Exact, _) => [0.0, 1.0],
                (FlareMode::Blended, Some(table)) if table.is_traced(ghost) => {
                    fractions(blend, f64::INFINITY)
                }
                (FlareMode::Blended, Some(table)) => match table.ghost(ghost) {
                    Some(tabled) => fractions(blend, tabled.nonlinearity_error(source.angle)),
                    None => [1.0, 0.0],
                },
                (FlareMode::Blended, None) => {
                    let nonlinearity_error = nonlinearity(lens, ghost, source.angle, source.f_number);
                    fractions(blend, nonlinearity_error.unwrap_or(f64::INFINITY))
                }
            };
            let drawn = |is_drawn: bool, fraction: f64| if is_drawn { fraction } else { 0.0 };
            Part {
                ghost,
                linear: drawn(asked.pattern != Pattern::Nonlinear, linear),
                nonlinear: drawn(asked.pattern != Pattern::Linear, nonlinear),
            }
        })
        .collect()
}
