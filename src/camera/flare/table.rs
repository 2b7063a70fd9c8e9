//! Ghosts traced beforehand: the look-up table of strongly nonlinear ghosts (KR 10-1658883).
//!
//! For each ghost that departs from its linear image: grids of rays at some angles of the source, in two colours. Between
//! angles, colours and rays the table is interpolated; the turn round the axis is made at play-back, as the lens is
//! symmetrical. Angles are added where the interpolation is worst, until it is near enough.

use glam::DVec2;
use half::f16;
use rayon::prelude::*;

use super::grid::RayGrid;
use super::linear::{LinearGhost, stop_radius};
use super::nonlinear::{LINEAR_ENOUGH, nonlinearity};
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::paraxial::Paraxial;
use crate::camera::path::{Ghost, single_crossing_ghosts};
use crate::camera::trace::{TracedRay, Tracer};

/// Rays along a side of a stored grid, even.
const SIDE: usize = 10;
/// Wavelengths that are stored, micrometres; others follow by 1 / wavelength², in which glass is nearly linear (Cauchy).
const COLOURS_UM: [f64; 2] = [0.475, 0.650];
/// Angles to begin with, and how often the way between two may be halved.
const FIRST_ANGLES: usize = 5;
const MOST_HALVINGS: u32 = 3;
/// Interpolation error that is near enough, as a share of the sensor's half diagonal.
const NEAR_ENOUGH: f64 = 0.004;

/// The table of a lens at an f-number.
#[derive(Clone, Debug)]
pub struct FlareTable {
    ghosts: Vec<TabledGhost>,
}

/// One ghost's grids by angle.
#[derive(Clone, Debug)]
pub struct TabledGhost {
    ghost: Ghost,
    steps: Vec<Step>,
}

/// Grids at one angle.
#[derive(Clone, Debug)]
struct Step {
    /// Radians.
    angle: f64,
    /// Corners of the entrance window, millimetres; none where no light gets through.
    window: Option<[DVec2; 2]>,
    /// Per stored colour: middle of the sensor places, then per ray of the half below the beam's plane (the other half is
    /// its mirror image) sensor place from there (mm), place in the stop (mm),
    /// relative height, root of the power. A lost ray is infinitely high.
    colours: Vec<(DVec2, Vec<[f16; 6]>)>,
}

impl FlareTable {
    /// Traces all ghosts that depart from linear at any angle up to `most_angle` radians.
    pub fn bake(lens: &Lens, f_number: f64, most_angle: f64) -> Self {
        let ghosts = single_crossing_ghosts(lens)
            .into_par_iter()
            .filter_map(|ghost| {
                let angle_of = |k: usize| most_angle * k as f64 / (FIRST_ANGLES - 1) as f64;
                let departs = (0..FIRST_ANGLES).any(|k| {
                    nonlinearity(lens, ghost, angle_of(k), f_number).is_none_or(|off| off > LINEAR_ENOUGH)
                });
                if !departs {
                    return None;
                }
                let step = |angle: f64| Step::trace(lens, ghost, angle, f_number);
                let half_diagonal = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
                let mut steps = vec![step(0.0)];
                for k in 1..FIRST_ANGLES {
                    let next = step(angle_of(k));
                    let before = steps[steps.len() - 1].clone();
                    refine(
                        &step,
                        &before,
                        &next,
                        NEAR_ENOUGH * half_diagonal,
                        MOST_HALVINGS,
                        &mut steps,
                    );
                    steps.push(next);
                }
                steps
                    .iter()
                    .any(|step| step.window.is_some())
                    .then_some(TabledGhost { ghost, steps })
            })
            .collect();
        Self { ghosts }
    }

    /// A ghost's grids; none for one that is linear enough.
    pub fn ghost(&self, ghost: Ghost) -> Option<&TabledGhost> {
        self.ghosts.iter().find(|tabled| tabled.ghost == ghost)
    }

    /// Number of ghosts in it.
    pub fn len(&self) -> usize {
        self.ghosts.len()
    }

    /// Whether every ghost is linear enough.
    pub fn is_empty(&self) -> bool {
        self.ghosts.is_empty()
    }

    /// Bytes of all grids.
    pub fn bytes(&self) -> usize {
        let of_step = |step: &Step| {
            48 + step
                .colours
                .iter()
                .map(|(_, rays)| 16 + 12 * rays.len())
                .sum::<usize>()
        };
        self.ghosts
            .iter()
            .flat_map(|ghost| &ghost.steps)
            .map(of_step)
            .sum()
    }
}

/// Adds angles between two steps where the middle is not near what they give.
fn refine(
    step: &dyn Fn(f64) -> Step,
    low: &Step,
    high: &Step,
    near_mm: f64,
    halvings: u32,
    steps: &mut Vec<Step>,
) {
    if halvings == 0 {
        return;
    }
    let middle = step(0.5 * (low.angle + high.angle));
    let off = match (&middle.window, Step::between(low, high, middle.angle)) {
        (None, None) => 0.0,
        (Some(_), Some(guess)) => middle.distance(&guess),
        _ => f64::INFINITY,
    };
    if off <= near_mm {
        return;
    }
    refine(step, low, &middle, near_mm, halvings - 1, steps);
    steps.push(middle.clone());
    refine(step, &middle, high, near_mm, halvings - 1, steps);
}

impl Step {
    fn trace(lens: &Lens, ghost: Ghost, angle: f64, f_number: f64) -> Self {
        let d_line = Paraxial::new(lens, D_LINE_UM, None);
        let stop_mm = stop_radius(lens, &d_line, f_number);
        let linear = LinearGhost::new(lens, &d_line, ghost, angle, stop_mm);
        let tracer = Tracer::new(lens, D_LINE_UM, d_line.sensor_gap_mm());
        let window = RayGrid::window(&tracer, ghost, angle, &linear);
        let colours = window.map_or_else(Vec::new, |window| {
            COLOURS_UM
                .map(|um| {
                    let tracer = Tracer::new(lens, um, d_line.sensor_gap_mm());
                    packed(&RayGrid::over(&tracer, ghost, angle, window, SIDE))
                })
                .to_vec()
        });
        Self {
            angle,
            window,
            colours,
        }
    }

    /// Linear between two steps; none where either lets no light through.
    fn between(low: &Self, high: &Self, angle: f64) -> Option<Self> {
        let share = (angle - low.angle) / (high.angle - low.angle);
        let ([a, b], [c, d]) = (low.window?, high.window?);
        let mix = |from: f16, to: f16| f16::from_f64(from.to_f64() * (1.0 - share) + to.to_f64() * share);
        let colours = low
            .colours
            .iter()
            .zip(&high.colours)
            .map(|((from, rays), (to, others))| {
                let rays = rays
                    .iter()
                    .zip(others)
                    .map(|(a, b)| std::array::from_fn(|k| mix(a[k], b[k])))
                    .collect();
                (from.lerp(*to, share), rays)
            })
            .collect();
        Some(Self {
            angle,
            window: Some([a.lerp(c, share), b.lerp(d, share)]),
            colours,
        })
    }

    /// Largest distance on the sensor of rays that get through in both, millimetres.
    fn distance(&self, other: &Self) -> f64 {
        let places = |step: &Self| -> Vec<Option<DVec2>> {
            step.colours
                .iter()
                .flat_map(|(middle, rays)| {
                    rays.iter().map(move |ray| {
                        let open = ray[4].to_f64() <= 1.0;
                        open.then(|| *middle + DVec2::new(ray[0].to_f64(), ray[1].to_f64()))
                    })
                })
                .collect()
        };
        places(self)
            .into_iter()
            .zip(places(other))
            .filter_map(|(a, b)| Some(a?.distance(b?)))
            .fold(0.0, f64::max)
    }
}

fn packed(grid: &RayGrid) -> (DVec2, Vec<[f16; 6]>) {
    let alive: Vec<DVec2> = grid.rays.iter().flatten().map(|ray| ray.sensor_mm).collect();
    let middle = DVec2::new(
        alive.iter().map(|at| at.x).sum::<f64>() / alive.len().max(1) as f64,
        0.0,
    );
    let rays = grid
        .rays
        .iter()
        .take(SIDE * SIDE / 2)
        .map(|ray| {
            ray.map_or([f16::INFINITY; 6], |ray| {
                let at = ray.sensor_mm - middle;
                [
                    at.x,
                    at.y,
                    ray.stop_mm.x,
                    ray.stop_mm.y,
                    ray.relative_height,
                    ray.power.sqrt(),
                ]
                .map(f16::from_f64)
            })
        })
        .collect();
    (middle, rays)
}

impl TabledGhost {
    /// The ghost's rays at an angle and wavelength, on a grid of `side` rays a side; none beyond the table and where no
    /// light gets through.
    pub fn grid(&self, angle: f64, wavelength_um: f64, side: usize) -> Option<RayGrid> {
        let next = self.steps.iter().position(|step| step.angle >= angle)?;
        let step = match next {
            0 => self.steps[0].clone(),
            _ => Step::between(&self.steps[next - 1], &self.steps[next], angle)?,
        };
        let [low, high] = step.window?;
        let inverse_square = |um: f64| um.powi(-2);
        let [blue, red] = COLOURS_UM.map(inverse_square);
        let share = (inverse_square(wavelength_um) - blue) / (red - blue);
        let coarse: Vec<Option<[f64; 6]>> = (0..SIDE * SIDE)
            .map(|k| {
                // The other half is this one's mirror image.
                let (column, row) = (k % SIDE, k / SIDE);
                let (stored, mirror) = if row < SIDE / 2 {
                    (row, 1.0)
                } else {
                    (SIDE - 1 - row, -1.0)
                };
                let value = |colour: usize| {
                    let (middle, rays) = &step.colours[colour];
                    let [x, y, stop_x, stop_y, height, root] = rays[stored * SIDE + column].map(f16::to_f64);
                    [middle.x + x, mirror * y, stop_x, mirror * stop_y, height, root]
                };
                let (a, b) = (value(0), value(1));
                let mixed: [f64; 6] = std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share);
                mixed.iter().all(|value| value.is_finite()).then_some(mixed)
            })
            .collect();
        let side = side.max(2);
        let rays = (0..side * side)
            .map(|k| {
                let place = |index: usize| index as f64 / (side - 1) as f64 * (SIDE - 1) as f64;
                smooth(&coarse, place(k % side), place(k / side)).map(|value| TracedRay {
                    sensor_mm: DVec2::new(value[0], value[1]),
                    stop_mm: DVec2::new(value[2], value[3]),
                    relative_height: value[4],
                    relative_stop: 0.0,
                    power: value[5] * value[5],
                })
            })
            .collect();
        Some(RayGrid {
            low,
            high,
            side,
            rays,
        })
    }
}

/// Catmull & Rom's spline (1974) through a grid's values; straight between two where the ones beyond are missing.
fn smooth(grid: &[Option<[f64; 6]>], x: f64, y: f64) -> Option<[f64; 6]> {
    let along = |at: f64, value: &dyn Fn(usize) -> Option<[f64; 6]>| -> Option<[f64; 6]> {
        let index = (at.floor() as usize).min(SIDE - 2);
        let t = at - index as f64;
        let (p1, p2) = (value(index)?, value(index + 1)?);
        let beyond = |from: [f64; 6], to: [f64; 6]| std::array::from_fn(|k| 2.0 * from[k] - to[k]);
        let p0 = index
            .checked_sub(1)
            .and_then(value)
            .unwrap_or_else(|| beyond(p1, p2));
        let p3 = Some(index + 2)
            .filter(|&k| k < SIDE)
            .and_then(value)
            .unwrap_or_else(|| beyond(p2, p1));
        Some(std::array::from_fn(|k| {
            let (a, b, c, d) = (p0[k], p1[k], p2[k], p3[k]);
            0.5 * (2.0 * b
                + (c - a) * t
                + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t
                + (3.0 * b - a - 3.0 * c + d) * t * t * t)
        }))
    };
    along(y, &|row| along(x, &|column| grid[row * SIDE + column]))
}
