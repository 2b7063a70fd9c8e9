//! Ghosts as triangles on the sensor, each corner knowing where its ray crossed the stop and the lens barrel.
//!
//! - **paraxial**: four entrance points a ghost and wavelength, carried by the matrices (KR 10-1465658; Lee & Eisemann
//!   2013, section 4): one flare quad.
//! - **exact**: a grid of rays over the entrance, traced surface by surface (Hullin et al. 2011).
//! - **blended**: the quad where a ghost is nearly linear, the traced grid where it departs from that (KR 10-1658883).
//!
//! Energy: a beam of irradiance E on the entrance arrives as E · power · |entrance area / sensor area|. A scene of radiance
//! L gives the sensor π L / (4 N²) at f-number N, so that a ghost adds the radiance E · power · areas · 4 N² / π.

use glam::DVec2;
use rayon::prelude::*;

use super::grid::RayGrid;
use super::linear::{LinearGhost, stop_radius};
use super::nonlinear::{LINEAR_ENOUGH, nonlinearity};
use super::source::{FlareSource, FlareVertex, radiance, turned};
use super::table::FlareTable;
use super::{Wavelength, spectrum};
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::paraxial::Paraxial;
use crate::camera::path::{Ghost, single_crossing_ghosts};
use crate::camera::trace::{Tracer, beam_direction};

/// How ghosts are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum FlareMode {
    /// Flare quads by the matrices alone.
    Paraxial,
    /// Quads for nearly linear ghosts, traced rays for the others.
    Blended,
    /// Traced rays for all.
    Exact,
}

/// Triangles of all ghosts that cross the stop once; `only` draws a single one. A table, baked for the same lens and f-number,
/// takes the place of tracing in the blended mode.
pub fn flare_mesh(
    lens: &Lens,
    source: &FlareSource,
    mode: FlareMode,
    only: Option<Ghost>,
    table: Option<&FlareTable>,
) -> Vec<FlareVertex> {
    let ghosts = match only {
        Some(ghost) => vec![ghost],
        None => single_crossing_ghosts(lens),
    };
    let colours = spectrum(source.wavelengths);
    // The sensor stays in the focus of the d line for every colour.
    let d_line = Paraxial::new(lens, D_LINE_UM, None);
    let gap = d_line.sensor_gap_mm();
    // So is the iris set.
    let stop_mm = stop_radius(lens, &d_line, source.f_number);
    let optics: Vec<(Wavelength, Paraxial)> = colours
        .into_iter()
        .map(|colour| (colour, Paraxial::new(lens, colour.um, Some(gap))))
        .collect();
    ghosts
        .par_iter()
        .flat_map_iter(|&ghost| optics.iter().map(move |optics| (ghost, optics)))
        .flat_map_iter(|(ghost, (colour, paraxial))| {
            let tracer = Tracer::new(lens, colour.um, gap);
            let linear = LinearGhost::new(lens, paraxial, ghost, source.angle, stop_mm);
            if let (FlareMode::Blended, Some(table)) = (mode, table) {
                return match table.ghost(ghost) {
                    Some(tabled) => tabled
                        .grid(source.angle, colour.um, source.rays)
                        .map_or_else(Vec::new, |grid| grid.triangles(source, *colour, stop_mm)),
                    None => quad(&tracer, &linear, *colour, source, ghost),
                };
            }
            let traced = match mode {
                FlareMode::Paraxial => false,
                FlareMode::Exact => true,
                FlareMode::Blended => nonlinearity(lens, ghost, source.angle, source.f_number)
                    .is_none_or(|off| off > LINEAR_ENOUGH),
            };
            if traced {
                traced_ghost(&tracer, &linear, *colour, source, ghost)
            } else {
                quad(&tracer, &linear, *colour, source, ghost)
            }
        })
        .collect()
}

/// Share of the way from a quad's middle to its side where a ray still passes the iris.
const INNER: f64 = 0.6;

/// The flare quad of a ghost.
fn quad(
    tracer: &Tracer<'_>,
    linear: &LinearGhost,
    colour: Wavelength,
    source: &FlareSource,
    ghost: Ghost,
) -> Vec<FlareVertex> {
    if linear.is_shut() {
        return Vec::new();
    }
    let corners = if source.whole_entrance {
        [DVec2::ZERO, DVec2::splat(linear.barrel_mm)]
    } else {
        [linear.middle, linear.half]
    };
    // Losses at the true angles of the ray through the middle; of an axial one where that ray does not arrive.
    let middle = tracer.trace(Some(ghost), linear.middle, beam_direction(source.angle));
    let axial = || tracer.trace(Some(ghost), DVec2::ZERO, beam_direction(0.0));
    let Some(power) = middle.or_else(axial).map(|ray| ray.power) else {
        return Vec::new();
    };
    // Losses change over the quad linearly, by rays to either side that the iris still lets through.
    let beside = |offset: DVec2| {
        let inner = linear.middle + INNER * linear.half * offset;
        tracer
            .trace(Some(ghost), inner, beam_direction(source.angle))
            .map_or(power, |ray| ray.power)
    };
    let slope = DVec2::new(
        beside(DVec2::X) - beside(DVec2::NEG_X),
        beside(DVec2::Y) - beside(DVec2::NEG_Y),
    ) / (2.0 * INNER * linear.half);
    let corner = |column: usize, row: usize| {
        let side = DVec2::new(column as f64, row as f64) * 2.0 - 1.0;
        let entry = corners[0] + corners[1] * side;
        let there = power + slope.dot(entry - linear.middle);
        let radiance = radiance(source, colour, there, linear.f[0].powi(-2));
        FlareVertex {
            sensor_mm: turned(linear.sensor(entry), source),
            stop: turned(linear.stop(entry) / -linear.stop_mm, source),
            barrel: turned(entry / linear.barrel_mm, source),
            radiance,
        }
    };
    [(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)]
        .map(|(column, row)| corner(column, row))
        .to_vec()
}

/// A ghost by traced rays.
fn traced_ghost(
    tracer: &Tracer<'_>,
    linear: &LinearGhost,
    colour: Wavelength,
    source: &FlareSource,
    ghost: Ghost,
) -> Vec<FlareVertex> {
    RayGrid::window(tracer, ghost, source.angle, linear).map_or_else(Vec::new, |window| {
        RayGrid::over(tracer, ghost, source.angle, window, source.rays.max(2)).triangles(
            source,
            colour,
            linear.stop_mm,
        )
    })
}
