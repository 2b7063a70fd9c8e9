//! Ghosts as triangles on the sensor, each vertex knowing where its ray crossed the stop and the lens barrel.
//!
//! - **paraxial**: four entrance points a ghost and wavelength, carried by the matrices (KR 10-1465658; Lee & Eisemann
//!   2013, section 4): one flare quad. **two rays**: the same from two points.
//! - **exact**: a grid of rays over the entrance, traced surface by surface (Hullin et al. 2011).
//! - **blended**: quads where ghosts are nearly linear, grids where they are not, traced or out of a table
//!   (KR 10-1658883).
//!
//! Energy: a beam of irradiance E on the entrance arrives as E · power · |entrance area / sensor area|. A scene of radiance
//! L gives the sensor π L / (4 N²) at f-number N, so that a ghost adds the radiance E · power · areas · 4 N² / π.

use glam::DVec2;
use rayon::prelude::*;

use super::blend::{Blend, Fit, fitted, fractions};
use super::grid::{RayGrid, SEARCH_RAYS};
use super::linear::{LinearGhost, stop_radius};
use super::nonlinearity::nonlinearity;
use super::parameters::{FlareMode, FlareParameters, Pattern};
use super::quad::{Losses, quad, two_rays};
use super::vertex::FlareVertex;
use crate::camera::flare::{Wavelength, spectrum};
use crate::camera::lens::D_LINE_UM;
use crate::camera::paraxial::Paraxial;
use crate::camera::path::{Ghost, single_crossing_ghosts};
use crate::camera::ray_bundles::Bundle;
use crate::camera::trace::Tracer;
use crate::gpu::GpuError;

/// Triangles, three vertices each.
#[derive(Clone, Debug, Default)]
pub struct FlareMesh {
    /// Ghosts that add up.
    pub added: Vec<FlareVertex>,
    /// What hides those, without light of its own.
    pub masks: Vec<FlareVertex>,
    /// Ghosts that add to what is left.
    pub above: Vec<FlareVertex>,
}

impl FlareMesh {
    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        (self.added.len() + self.masks.len() + self.above.len()) / 3
    }

    /// Area of all triangles, also beside the film, square millimetres.
    pub fn area_mm2(&self) -> f64 {
        let parts = [&self.added, &self.masks, &self.above];
        let triangles = parts.into_iter().flat_map(|vertices| vertices.chunks_exact(3));
        triangles.map(triangle_area_mm2).sum()
    }
}

fn triangle_area_mm2(triangle: &[FlareVertex]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k: usize| glam::Vec2::from_array(triangle[k].sensor_mm).as_dvec2());
    0.5 * (b - a).perp_dot(c - a).abs()
}

/// Rays traced and turned into triangles at a time.
const RAYS_AT_ONCE: usize = 1 << 18;

/// A ghost and the fractions of its linear and its nonlinear image.
struct Part {
    ghost: Ghost,
    linear: f64,
    nonlinear: f64,
}

/// The optics of one colour.
struct Optics {
    colour: Wavelength,
    paraxial: Paraxial,
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

    let quads = parts.par_iter().filter(|part| part.linear > 0.0);
    let mut added: Vec<FlareVertex> = quads
        .flat_map_iter(|part| optics.iter().map(move |optics| (part, optics)))
        .flat_map_iter(|(part, optics)| {
            let tracer = Tracer::new(lens, optics.colour.um, gap);
            let linear = linear_of(part.ghost, &optics.paraxial);
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
        })
        .collect();

    let masking = &optics[optics.len() / 2];
    let curved: Vec<&Part> = parts.iter().filter(|part| part.nonlinear > 0.0).collect();
    let grids_of = |jobs: &[(&Part, &Optics)], grids: Vec<Option<RayGrid>>| -> Vec<FlareVertex> {
        jobs.par_iter()
            .zip(grids)
            .flat_map_iter(|((part, optics), grid)| {
                let linear = linear_of(part.ghost, &optics.paraxial);
                let triangles = |grid: RayGrid| {
                    let grid = if ghosts.fit == Fit::default() {
                        grid
                    } else {
                        let tracer = Tracer::new(lens, optics.colour.um, gap);
                        match Losses::from_ray(&tracer, &linear, &source, part.ghost) {
                            Some(losses) => fitted(grid, &linear, &losses, ghosts.fit),
                            None => grid,
                        }
                    };
                    let opacity = if std::ptr::eq(*optics, masking) {
                        part.nonlinear
                    } else {
                        0.0
                    };
                    grid.triangles(&source, optics.colour, stop_mm, part.nonlinear, opacity)
                };
                grid.map_or_else(Vec::new, triangles)
            })
            .collect()
    };
    let mut traced = Vec::new();
    if let (FlareMode::Blended, Some(table)) = (ghosts.mode, parameters.table) {
        let evaluated = |&part: &&Part| {
            let evaluated = table.ghost(part.ghost).and_then(|ghost| ghost.at(source.angle));
            let grid = |optics: &Optics| {
                evaluated
                    .as_ref()
                    .map(|evaluated| evaluated.grid(optics.colour.um, ghosts.rays))
            };
            let jobs: Vec<_> = optics.iter().map(|optics| (part, optics)).collect();
            grids_of(&jobs, optics.iter().map(grid).collect())
        };
        traced = curved.par_iter().flat_map_iter(evaluated).collect();
    } else {
        // Where each ghost's light comes in, by a coarse grid over the whole front in the centre of the spectrum.
        let linears: Vec<LinearGhost> = curved.iter().map(|part| linear_of(part.ghost, &d_line)).collect();
        let whole = |(part, linear): (&&Part, &LinearGhost)| Bundle {
            ghost: Some(part.ghost),
            wavelength_um: D_LINE_UM,
            angle: source.angle,
            min: DVec2::splat(-linear.barrel_mm),
            max: DVec2::splat(linear.barrel_mm),
        };
        let searches: Vec<Bundle> = curved.iter().zip(&linears).map(whole).collect();
        let found = parameters.tracing.grids(lens, gap, &searches, SEARCH_RAYS)?;
        let mut jobs = Vec::new();
        for ((&part, linear), search) in curved.iter().zip(&linears).zip(&found) {
            if let Some([min, max]) = search.window(linear) {
                jobs.extend(optics.iter().map(|optics| {
                    let bundle = Bundle {
                        ghost: Some(part.ghost),
                        wavelength_um: optics.colour.um,
                        angle: source.angle,
                        min,
                        max,
                    };
                    ((part, optics), bundle)
                }));
            }
        }
        let at_once = (RAYS_AT_ONCE / ghosts.rays.pow(2).max(1)).max(1);
        for jobs in jobs.chunks(at_once) {
            let (jobs, bundles): (Vec<_>, Vec<_>) = jobs.iter().copied().unzip();
            let grids = parameters.tracing.grids(lens, gap, &bundles, ghosts.rays)?;
            traced.extend(grids_of(&jobs, grids.into_iter().map(Some).collect()));
        }
    }
    if ghosts.mode != FlareMode::Blended || ghosts.blend != Blend::Alpha {
        added.extend(traced);
        traced = Vec::new();
    }
    // One colour masks for all: each would hide the others.
    let masks = traced
        .iter()
        .filter(|vertex| vertex.opacity > 0.0)
        .map(|vertex| FlareVertex {
            radiance: [0.0; 3],
            ..*vertex
        })
        .collect();
    Ok(FlareMesh {
        added,
        masks,
        above: traced,
    })
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
                (FlareMode::Blended, Some(table)) => match table.ghost(ghost) {
                    Some(_) if blend == Blend::Add => [0.0, 1.0],
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
