//! Ghosts as triangles on the sensor, each corner knowing where its ray crossed the stop and the lens barrel.
//!
//! - **paraxial**: four entrance points a ghost and wavelength, carried by the matrices (KR 10-1465658; Lee & Eisemann
//!   2013, section 4): one flare quad.
//! - **exact**: a grid of rays over the entrance, traced surface by surface (Hullin et al. 2011).
//! - **blended**: the quad where a ghost is nearly linear, the traced grid where it departs from that (KR 10-1658883).
//!
//! Energy: a beam of irradiance E on the entrance arrives as E · power · |entrance area / sensor area|. A scene of radiance
//! L gives the sensor π L / (4 N²) at f-number N, so that a ghost adds the radiance E · power · areas · 4 N² / π.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;
use rayon::prelude::*;

use super::{Wavelength, spectrum};
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::paraxial::Paraxial;
use crate::camera::path::{Ghost, single_crossing_ghosts};
use crate::camera::trace::{TracedRay, Tracer, beam_direction};

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

/// A distant small source, and the camera that sees it.
#[derive(Clone, Copy, Debug)]
pub struct FlareSource {
    /// Angle from the axis, radians.
    pub angle: f64,
    /// Direction in the picture, from +x (right) towards +y (up), radians.
    pub turn: f64,
    /// Irradiance on a surface facing it, linear sRGB, in units of the picture's radiance times steradians.
    pub irradiance: [f64; 3],
    /// The camera's f-number.
    pub f_number: f64,
    /// Wavelengths.
    pub wavelengths: usize,
    /// Rays along a side of a traced grid.
    pub rays: usize,
    /// Draw quads over the whole front of the lens, not its effective pupil alone: the same picture by more work.
    pub whole_entrance: bool,
}

/// A corner of a ghost's triangle; layout of the vertex buffer of `shaders/camera/flare.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FlareVertex {
    /// On the picture, millimetres of the sensor, x right and y up (the sensor's image turned upright).
    pub sensor_mm: [f32; 2],
    /// In the stop, as a share of its radius at this f-number.
    pub stop: [f32; 2],
    /// In the lens barrel: over length 1 the ray is held.
    pub barrel: [f32; 2],
    /// Radiance added.
    pub radiance: [f32; 3],
}

/// Departure of a ghost from its linear image at an angle in radians: the largest distance between traced and paraxial rays
/// that pass stop and barrel, as a share of the sensor's half diagonal; or, if that is more, the share of the rays that a
/// barrel inside the lens holds. None when no ray passes.
pub fn nonlinearity(lens: &Lens, ghost: Ghost, angle: f64, f_number: f64) -> Option<f64> {
    let paraxial = Paraxial::new(lens, D_LINE_UM, None);
    let tracer = Tracer::new(lens, D_LINE_UM, paraxial.sensor_gap_mm());
    let stop_mm = stop_radius(lens, &paraxial, f_number);
    let linear = LinearGhost::new(lens, &paraxial, ghost, angle, stop_mm);
    let half_diagonal = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
    let side = 13;
    let mut worst: Option<f64> = None;
    let (mut passing, mut held) = (0_u32, 0_u32);
    for k in 0..side * side {
        let entry = linear.entrance(k % side, k / side, side);
        let is_open = linear.stop(entry).length() <= linear.stop_mm && entry.length() <= linear.barrel_mm;
        let Some(ray) = tracer.trace(Some(ghost), entry, beam_direction(angle)) else {
            held += u32::from(is_open);
            continue;
        };
        held += u32::from(is_open && ray.relative_height > 1.0);
        passing += u32::from(is_open);
        if ray.relative_height <= 1.0 && ray.stop_mm.length() <= linear.stop_mm {
            let off = (ray.sensor_mm - linear.sensor(entry)).length() / half_diagonal;
            worst = Some(worst.unwrap_or(0.0).max(off));
        }
    }
    let share = f64::from(held) / f64::from(passing.max(1));
    worst.map(|off| off.max(share))
}

/// One ghost in one colour by its matrices.
struct LinearGhost {
    /// First row of `ma`: height in the stop per entrance height and per slope.
    a: [f64; 2],
    /// First row of `mf`, likewise on the sensor.
    f: [f64; 2],
    slope: DVec2,
    stop_mm: f64,
    barrel_mm: f64,
    /// Middle of the part of the entrance that is drawn, and half its sides.
    middle: DVec2,
    half: DVec2,
}

impl LinearGhost {
    fn new(lens: &Lens, paraxial: &Paraxial, ghost: Ghost, angle: f64, stop_mm: f64) -> Self {
        let matrices = paraxial.matrices(Some(ghost));
        let a = [matrices.ma.x_axis.x, matrices.ma.y_axis.x];
        let f = [matrices.mf.x_axis.x, matrices.mf.y_axis.x];
        let slope = DVec2::new(angle.tan(), 0.0);
        let barrel_mm = barrel_radius(lens, paraxial);
        // The effective pupil, r_e = (±r_a - Ma12 θ) / Ma11: what the stop lets through, seen from the front; of it what
        // the barrel lets in.
        let pupil = -a[1] / a[0] * slope;
        let reach = DVec2::splat((stop_mm / a[0]).abs());
        let low = (pupil - reach).max(DVec2::splat(-barrel_mm));
        let high = (pupil + reach).min(DVec2::splat(barrel_mm));
        Self {
            a,
            f,
            slope,
            stop_mm,
            barrel_mm,
            middle: 0.5 * (low + high),
            half: 0.5 * (high - low),
        }
    }

    /// Nothing of the pupil lies within the barrel.
    fn is_shut(&self) -> bool {
        self.half.x <= 0.0 || self.half.y <= 0.0 || !self.half.is_finite()
    }

    fn entrance(&self, column: usize, row: usize, side: usize) -> DVec2 {
        let share = |index: usize| 2.0 * index as f64 / (side - 1) as f64 - 1.0;
        self.middle + self.half * DVec2::new(share(column), share(row))
    }

    fn sensor(&self, entry: DVec2) -> DVec2 {
        self.f[0] * entry + self.f[1] * self.slope
    }

    fn stop(&self, entry: DVec2) -> DVec2 {
        self.a[0] * entry + self.a[1] * self.slope
    }
}

/// Radius of the stop at an f-number, no wider than it opens, millimetres.
fn stop_radius(lens: &Lens, paraxial: &Paraxial, f_number: f64) -> f64 {
    paraxial.stop_radius(f_number).min(lens.clear_radius(lens.stop))
}

/// Radius that the front of the lens lets in, millimetres.
fn barrel_radius(lens: &Lens, paraxial: &Paraxial) -> f64 {
    let front = lens.clear_radius(0);
    if front.is_finite() {
        front
    } else {
        1.5 * paraxial.entrance_pupil(lens.clear_radius(lens.stop).min(0.5 * paraxial.efl_mm.abs()))
    }
}

/// Departure beyond which a ghost is traced in the blended mode, as a share of the sensor's half diagonal.
const LINEAR_ENOUGH: f64 = 0.004;

/// Triangles of all ghosts that cross the stop once; `only` draws a single one.
pub fn flare_mesh(
    lens: &Lens,
    source: &FlareSource,
    mode: FlareMode,
    only: Option<Ghost>,
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
            let traced = match mode {
                FlareMode::Paraxial => false,
                FlareMode::Exact => true,
                FlareMode::Blended => nonlinearity(lens, ghost, source.angle, source.f_number)
                    .is_none_or(|off| off > LINEAR_ENOUGH),
            };
            if traced {
                traced_ghost(lens, paraxial, *colour, source, ghost, stop_mm)
            } else {
                quad(lens, paraxial, *colour, source, ghost, stop_mm)
            }
        })
        .collect()
}

/// From a beam in the x-z plane to the picture.
fn turned(at: DVec2, source: &FlareSource) -> [f32; 2] {
    DVec2::from_angle(source.turn).rotate(at).as_vec2().to_array()
}

fn radiance(source: &FlareSource, colour: Wavelength, power: f64, areas: f64) -> [f32; 3] {
    let scale = power * areas * 4.0 * source.f_number.powi(2) / std::f64::consts::PI;
    [0, 1, 2].map(|channel| (source.irradiance[channel] * colour.rgb[channel] * scale) as f32)
}

/// Share of the way from a quad's middle to its side where a ray still passes the iris.
const INNER: f64 = 0.6;

/// The flare quad of a ghost.
fn quad(
    lens: &Lens,
    paraxial: &Paraxial,
    colour: Wavelength,
    source: &FlareSource,
    ghost: Ghost,
    stop_mm: f64,
) -> Vec<FlareVertex> {
    let linear = LinearGhost::new(lens, paraxial, ghost, source.angle, stop_mm);
    if linear.is_shut() {
        return Vec::new();
    }
    let corners = if source.whole_entrance {
        [DVec2::ZERO, DVec2::splat(linear.barrel_mm)]
    } else {
        [linear.middle, linear.half]
    };
    let tracer = Tracer::new(lens, colour.um, paraxial.sensor_gap_mm());
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

/// Rays along a side of the grid that finds where a ghost's light comes in.
const SEARCH_RAYS: usize = 25;

/// A ghost by traced rays.
fn traced_ghost(
    lens: &Lens,
    paraxial: &Paraxial,
    colour: Wavelength,
    source: &FlareSource,
    ghost: Ghost,
    stop_mm: f64,
) -> Vec<FlareVertex> {
    let tracer = Tracer::new(lens, colour.um, paraxial.sensor_gap_mm());
    let barrel_mm = barrel_radius(lens, paraxial);
    let direction = beam_direction(source.angle);
    let grid = |low: DVec2, high: DVec2, side: usize| -> Vec<(DVec2, Option<TracedRay>)> {
        (0..side * side)
            .map(|k| {
                let share = DVec2::new((k % side) as f64, (k / side) as f64) / (side - 1) as f64;
                let entry = low + (high - low) * share;
                (entry, tracer.trace(Some(ghost), entry, direction))
            })
            .collect()
    };
    // First the part of the entrance that gets through, with a cell round it and the linear pupil.
    let all = DVec2::splat(barrel_mm);
    let cell = 2.0 * barrel_mm / (SEARCH_RAYS - 1) as f64;
    let linear = LinearGhost::new(lens, paraxial, ghost, source.angle, stop_mm);
    let (mut low, mut high) = (linear.middle - linear.half, linear.middle + linear.half);
    if linear.is_shut() {
        (low, high) = (all, -all);
    }
    for (entry, ray) in grid(-all, all, SEARCH_RAYS) {
        let passes = |ray: TracedRay| ray.relative_height <= 1.05 && ray.stop_mm.length() <= 1.05 * stop_mm;
        if ray.is_some_and(passes) {
            low = low.min(entry - cell);
            high = high.max(entry + cell);
        }
    }
    let (low, high) = (low.max(-all), high.min(all));
    if low.x >= high.x || low.y >= high.y {
        return Vec::new();
    }
    let side = source.rays.max(2);
    let rays = grid(low, high, side);
    let area = (high - low).element_product() / ((side - 1) * (side - 1)) as f64;
    let mut vertices = Vec::new();
    for row in 0..side - 1 {
        for column in 0..side - 1 {
            let at = |dx: usize, dy: usize| rays[(row + dy) * side + column + dx].1;
            let (Some(a), Some(b), Some(c), Some(d)) = (at(0, 0), at(1, 0), at(1, 1), at(0, 1)) else {
                continue;
            };
            for corners in [[a, b, c], [a, c, d]] {
                let nearest = |key: fn(&TracedRay, f64) -> f64| {
                    corners
                        .iter()
                        .map(|ray| key(ray, stop_mm))
                        .fold(f64::INFINITY, f64::min)
                };
                if nearest(|ray, _| ray.relative_height) > 1.0
                    || nearest(|ray, stop_mm| ray.stop_mm.length() / stop_mm) > 1.5
                {
                    continue;
                }
                let [p, q, r] = corners.map(|ray| ray.sensor_mm);
                let landed = 0.5 * (q - p).perp_dot(r - p).abs();
                if landed < 1e-12 {
                    continue;
                }
                vertices.extend(corners.map(|ray| FlareVertex {
                    sensor_mm: turned(ray.sensor_mm, source),
                    stop: turned(ray.stop_mm / -stop_mm, source),
                    barrel: [ray.relative_height as f32, 0.0],
                    radiance: radiance(source, colour, ray.power, 0.5 * area / landed),
                }));
            }
        }
    }
    vertices
}
