//! Traces a lens's table: of many angles those become knots where the interpolation between others is worst, until it is near
//! enough at all.

use std::cell::OnceCell;
use std::collections::HashMap;

use glam::DVec2;
use rayon::prelude::*;

use super::knot::{COLOURS_UM, CURVE_UM, Knot, Light, SIZES, Unpacked, Values, values_of};
use super::nearness::Nearness;
use super::ray_table::{FlareTable, TabledGhost, between, smooth_grid};
use crate::camera::flare::ghost::grid::{CLOSER_LOOKS, MARGIN_STOP, RayGrid, SEARCH_RAYS};
use crate::camera::flare::ghost::linear::{LinearGhost, stop_radius};
use crate::camera::flare::ghost::nonlinearity::{LINEAR_ENOUGH, nonlinearity, outer_light};
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::paraxial::Paraxial;
use crate::camera::path::{Ghost, single_crossing_ghosts};
use crate::camera::trace::{TracedRay, Tracer, beam_direction};

/// Angles that are traced, at least, and at most so far apart, radians; those become knots that the others do not tell.
const MIN_ANGLES: usize = 41;
const ANGLE_STEP: f64 = 0.007;
/// Interpolation error that is near enough, as a fraction of the sensor's half diagonal.
const NEAR_ENOUGH: f64 = 0.006;
/// Angles between two knots at which interpolation is tested at most.
const MAX_TESTED_BETWEEN: usize = 7;
/// Angles to either side over which windows are smoothed.
const SMOOTH_ANGLES: usize = 2;
/// Nonlinearity error that stands for a ghost without light.
const FAR_OFF: f64 = 1e3;

impl FlareTable {
    /// Traces all ghosts that are nonlinear at any angle up to `max_angle` radians.
    pub fn bake(lens: &Lens, f_number: f64, max_angle: f64) -> Self {
        let tabled: Vec<Tabled> = single_crossing_ghosts(lens)
            .into_par_iter()
            .map(|ghost| tabled(lens, ghost, f_number, max_angle))
            .collect();
        let (mut ghosts, mut traced) = (Vec::new(), Vec::new());
        for ghost in tabled {
            match ghost {
                Tabled::Linear => {}
                Tabled::Grids(ghost) => ghosts.push(ghost),
                Tabled::Traced(Ghost { first, second }) => traced.push([first, second]),
            }
        }
        Self {
            f_number,
            max_angle,
            ghosts,
            traced,
        }
    }
}

/// What a table has of a ghost.
enum Tabled {
    /// Nothing: it is linear enough at all angles, or never lets light through.
    Linear,
    /// Its knots.
    Grids(TabledGhost),
    /// That it is to be traced.
    Traced(Ghost),
}

/// What a table has of a ghost.
fn tabled(lens: &Lens, ghost: Ghost, f_number: f64, max_angle: f64) -> Tabled {
    let angles = ((max_angle / ANGLE_STEP).ceil() as usize + 1).max(MIN_ANGLES);
    let optics: Vec<Optics<'_>> = (0..angles)
        .map(|k| Optics::new(lens, ghost, max_angle * k as f64 / (angles - 1) as f64, f_number))
        .collect();
    let windows: Vec<Option<[DVec2; 2]>> = optics.iter().map(Optics::window).collect();
    let nonlinearity_errors: Vec<f64> = optics
        .iter()
        .map(|optics| nonlinearity(lens, ghost, optics.angle, f_number).unwrap_or(FAR_OFF))
        .collect();
    let mut lit = nonlinearity_errors
        .iter()
        .zip(&windows)
        .filter(|(_, window)| window.is_some());
    if !lit.any(|(nonlinearity_error, _)| *nonlinearity_error > LINEAR_ENOUGH) {
        return Tabled::Linear;
    }
    let near = Nearness {
        sensor_mm: NEAR_ENOUGH * 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]),
        stop_mm: optics[0].linear.stop_mm,
        pupil_mm: (optics[0].linear.stop_mm / optics[0].linear.a[0])
            .abs()
            .min(optics[0].linear.barrel_mm),
    };
    let is_ring = optics.iter().step_by(angles / RING_ANGLES).any(Optics::is_ring);
    let max_off_fraction = if is_ring {
        MAX_OFF_FRACTION_OF_RING
    } else {
        MAX_OFF_FRACTION
    };
    let Some(size) = size_needed(&optics, &windows, &near, max_off_fraction) else {
        return Tabled::Traced(ghost);
    };
    let is_lit = |k: usize| windows.get(k).is_some_and(Option::is_some);
    // Beside light, also where none comes through: its rays, all vignetted somewhere, tell how the ghost closes.
    let lights: Vec<Option<[DVec2; 2]>> = (0..angles)
        .map(|k| {
            let is_beside = is_lit(k) || is_lit(k + 1) || k > 0 && is_lit(k - 1);
            is_beside.then(|| widened(&windows, k)).flatten()
        })
        .collect();
    // Those that are asked for.
    let known: Vec<OnceCell<Option<(Light, Unpacked)>>> = (0..angles).map(|_| OnceCell::new()).collect();
    let light_at = |k: usize| {
        let traced = || {
            let light = optics[k].light(lights[k]?, size);
            let unpacked = light.unpack();
            Some((light, unpacked))
        };
        known[k].get_or_init(traced).as_ref()
    };
    // The ends, and both sides of where light begins or ends.
    let mut is_knot: Vec<bool> = (0..angles)
        .map(|k| {
            let begins = |a: usize, b: usize| lights[a].is_some() != lights[b].is_some();
            k == 0 || k == angles - 1 || begins(k, k + 1) || begins(k - 1, k)
        })
        .collect();
    let grid_at = |k: Option<usize>| Some((optics.get(k?)?.angle, &light_at(k?)?.1));
    // The worst angle between two knots, told by them and the next on either side.
    let mut worst_known: HashMap<[Option<usize>; 4], Option<usize>> = HashMap::new();
    loop {
        let knots_at: Vec<usize> = (0..angles).filter(|&k| is_knot[k]).collect();
        let worst_of = |around: &[Option<usize>; 4]| {
            let [_, Some(lower), Some(upper), _] = *around else {
                return None;
            };
            let off = |k: usize| match (light_at(k), between(around.map(grid_at), optics[k].angle)) {
                (None, None) => 0.0,
                (Some((_, grid)), Some(guess)) => near.off(grid, &guess),
                _ => f64::INFINITY,
            };
            let (k, max) = tested(lower, upper)
                .map(|k| (k, off(k)))
                .max_by(|a, b| a.1.total_cmp(&b.1))?;
            (max > 1.0).then_some(k)
        };
        let worst: Vec<usize> = (1..knots_at.len())
            .filter_map(|next| {
                let knot = |index: Option<usize>| knots_at.get(index?).copied();
                let around = [next.checked_sub(2), Some(next - 1), Some(next), Some(next + 1)].map(knot);
                *worst_known.entry(around).or_insert_with_key(worst_of)
            })
            .collect();
        if worst.is_empty() {
            let knot = |k: usize| Knot {
                angle: optics[k].angle,
                nonlinearity_error: nonlinearity_errors[k].min(FAR_OFF) as f32,
                light: light_at(k).map(|(light, _)| light.clone()),
            };
            return Tabled::Grids(TabledGhost {
                first: ghost.first,
                second: ghost.second,
                knots: knots_at.into_iter().map(knot).collect(),
            });
        }
        for k in worst {
            is_knot[k] = true;
        }
    }
}

/// Angles between two knots at which interpolation is tested: all of a few, some of many, which become fewer as knots come between.
fn tested(lower: usize, upper: usize) -> impl Iterator<Item = usize> {
    let between = upper - lower - 1;
    let count = between.min(MAX_TESTED_BETWEEN);
    (1..=count).map(move |k| lower + (k * (between + 1) + count.div_ceil(2)) / (count + 1))
}

/// A window that holds the one at `k` and changes smoothly from angle to angle, as the rays of a grid do only if it does: the
/// mean over some angles of the hull over some angles.
fn widened(windows: &[Option<[DVec2; 2]>], k: usize) -> Option<[DVec2; 2]> {
    let near =
        |k: usize| &windows[k.saturating_sub(SMOOTH_ANGLES)..(k + SMOOTH_ANGLES + 1).min(windows.len())];
    let hull = |k: usize| {
        near(k)
            .iter()
            .flatten()
            .copied()
            .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    };
    let (from, to) = (
        k.saturating_sub(SMOOTH_ANGLES),
        (k + SMOOTH_ANGLES).min(windows.len() - 1),
    );
    let hulls: Vec<[DVec2; 2]> = (from..=to).filter_map(hull).collect();
    let count = hulls.len() as f64;
    let mean = |bound: usize| hulls.iter().map(|hull| hull[bound]).sum::<DVec2>() / count;
    (!hulls.is_empty()).then(|| [mean(0), mean(1)])
}

/// Angles at which it is tested how fine a ghost's grids are to be.
const TESTED_ANGLES: usize = 7;
/// Fraction of the rays between a grid's that may be off by more than is near enough.
const OFF_FRACTION: f64 = 0.03;

/// The same of the finest grids, over which a ghost is left to be traced.
const MAX_OFF_FRACTION: f64 = 0.085;
/// And of one whose light comes in through a ring, which a grid shows ragged.
const MAX_OFF_FRACTION_OF_RING: f64 = 0.05;
/// Angles at which such a ring is looked for.
const RING_ANGLES: usize = 4;

/// Rays along an edge of a ghost's grids: the least of `SIZES` by which the rays between a grid's are near enough, at angles spread over
/// those with light. None where not even the finest is anywhere near.
fn size_needed(
    optics: &[Optics<'_>],
    windows: &[Option<[DVec2; 2]>],
    near: &Nearness,
    max_off_fraction: f64,
) -> Option<usize> {
    let lit: Vec<usize> = (0..windows.len()).filter(|&k| windows[k].is_some()).collect();
    let step = lit.len().div_ceil(TESTED_ANGLES).max(1);
    let tested: Vec<(usize, [DVec2; 2])> = lit
        .into_iter()
        .step_by(step)
        .filter_map(|k| Some((k, widened(windows, k)?)))
        .collect();
    let mut off_fraction = 0.0;
    for size in SIZES {
        let (mut off, mut all) = (0, 0);
        for &(k, window) in &tested {
            let mut grid = optics[k].grid(D_LINE_UM, window, size);
            let passing = grid.rays.iter().map(|ray| ray.as_ref().map(values_of));
            let edge = near.edge(passing, window, size * size);
            grid.extend();
            let known: Vec<Option<Values>> =
                grid.rays.iter().map(|ray| ray.as_ref().map(values_of)).collect();
            let between = optics[k].grid(D_LINE_UM, window, 2 * size - 1);
            let smoothed = smooth_grid(&known, size, between.size);
            for (ray, smoothed) in between.rays.iter().zip(&smoothed) {
                let truth = ray.as_ref().map(values_of);
                if near.passes(&truth) {
                    all += 1;
                    off += usize::from(near.off_ray(&truth, smoothed, edge) > 1.0);
                }
            }
        }
        off_fraction = off as f64 / f64::from(all.max(1));
        if off_fraction <= OFF_FRACTION {
            return Some(size);
        }
    }
    let [.., finest] = SIZES;
    (off_fraction <= max_off_fraction).then_some(finest)
}

/// A ghost at an angle.
struct Optics<'a> {
    lens: &'a Lens,
    ghost: Ghost,
    angle: f64,
    sensor_gap_mm: f64,
    linear: LinearGhost,
}

impl<'a> Optics<'a> {
    fn new(lens: &'a Lens, ghost: Ghost, angle: f64, f_number: f64) -> Self {
        let d_line = Paraxial::new(lens, D_LINE_UM, None);
        let stop_mm = stop_radius(lens, &d_line, f_number);
        Self {
            lens,
            ghost,
            angle,
            sensor_gap_mm: d_line.sensor_gap_mm(),
            linear: LinearGhost::new(lens, &d_line, ghost, angle, stop_mm),
        }
    }

    /// Whether light comes in beyond the linear pupil.
    fn is_ring(&self) -> bool {
        let tracer = Tracer::new(self.lens, D_LINE_UM, self.sensor_gap_mm);
        outer_light(&tracer, self.ghost, self.angle, &self.linear) > LINEAR_ENOUGH
    }

    /// The part of the entrance that lets light through.
    fn window(&self) -> Option<[DVec2; 2]> {
        let all = DVec2::splat(self.linear.barrel_mm);
        let mut search = self.grid(D_LINE_UM, [-all, all], SEARCH_RAYS);
        for _ in 0..CLOSER_LOOKS {
            match search.closer(&self.linear) {
                Some(part) => search = self.grid(D_LINE_UM, part, SEARCH_RAYS),
                None => break,
            }
        }
        search.window(&self.linear, MARGIN_STOP)
    }

    /// Rays over a window. Where it lies evenly about the beam's plane, one half is the mirror image of the other.
    fn grid(&self, wavelength_um: f64, [min, max]: [DVec2; 2], size: usize) -> RayGrid {
        let tracer = Tracer::new(self.lens, wavelength_um, self.sensor_gap_mm);
        let direction = beam_direction(self.angle);
        let mut grid = RayGrid {
            min,
            max,
            size,
            rays: vec![None; size * size],
        };
        let is_even = (min.y + max.y).abs() < 1e-9 * (max.y - min.y);
        let rows = if is_even { size.div_ceil(2) } else { size };
        for k in 0..rows * size {
            grid.rays[k] = tracer.trace(Some(self.ghost), grid.entry(k), direction);
        }
        let mirrored = |ray: TracedRay| TracedRay {
            sensor_mm: ray.sensor_mm * DVec2::new(1.0, -1.0),
            stop_mm: ray.stop_mm * DVec2::new(1.0, -1.0),
            ..ray
        };
        for k in rows * size..size * size {
            let (column, row) = (k % size, k / size);
            grid.rays[k] = grid.rays[(size - 1 - row) * size + column].map(mirrored);
        }
        grid
    }

    fn light(&self, window: [DVec2; 2], size: usize) -> Light {
        let [mut blue, mut red] = COLOURS_UM.map(|um| self.grid(um, window, size));
        let curve = self.curve(&blue);
        blue.extend();
        red.extend();
        Light::packed([&blue, &red], curve)
    }

    /// Power of the passing ray nearest to the centre of those, by wavelength.
    fn curve(&self, grid: &RayGrid) -> [f64; CURVE_UM.len()] {
        let passing: Vec<DVec2> = grid
            .rays
            .iter()
            .enumerate()
            .filter(|(_, ray)| ray.is_some_and(|ray| ray.relative_height <= 1.0))
            .map(|(k, _)| grid.entry(k))
            .collect();
        let centre = passing.iter().sum::<DVec2>() / passing.len().max(1) as f64;
        let Some(entry) = passing
            .iter()
            .copied()
            .min_by(|a, b| a.distance(centre).total_cmp(&b.distance(centre)))
        else {
            return [1.0; CURVE_UM.len()];
        };
        let power = |um: f64| {
            let tracer = Tracer::new(self.lens, um, self.sensor_gap_mm);
            let ray = tracer.trace(Some(self.ghost), entry, beam_direction(self.angle));
            ray.map_or(0.0, |ray| ray.power)
        };
        let whole = power(COLOURS_UM[0]).max(1e-12);
        CURVE_UM.map(|um| power(um) / whole)
    }
}
