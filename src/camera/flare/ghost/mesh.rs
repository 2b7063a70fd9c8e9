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

use rayon::prelude::*;

use super::blend::{Blend, fractions};
use super::ghost_triangles::{GhostTriangles, triangle_area_mm2};
use super::layers::{Layer, layers};
use super::linear::{LinearGhost, stop_radius};
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
