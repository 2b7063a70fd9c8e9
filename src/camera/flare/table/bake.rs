//! Traces a lens's table: angles are added where the interpolation is worst, until it is near enough.

use glam::DVec2;
use rayon::prelude::*;

use super::rays::{FlareTable, TabledGhost, between};
use super::step::{COLOURS_UM, Light, SIDE, Step};
use crate::camera::flare::grid::{RayGrid, SEARCH_RAYS};
use crate::camera::flare::linear::{LinearGhost, stop_radius};
use crate::camera::flare::nonlinear::{LINEAR_ENOUGH, nonlinearity};
use crate::camera::flare::tracing::Tracing;
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::paraxial::Paraxial;
use crate::camera::path::{Ghost, single_crossing_ghosts};
use crate::camera::rays::Bundle;
use crate::gpu::GpuError;

/// Angles to begin with, and how often the way between two may be halved.
const FIRST_ANGLES: usize = 5;
const MOST_HALVINGS: usize = 3;
/// Interpolation error that is near enough, as a share of the sensor's half diagonal.
const NEAR_ENOUGH: f64 = 0.004;
/// Departure that stands for a ghost without light.
const FAR_OFF: f64 = 1e3;

impl FlareTable {
    /// Traces all ghosts that depart from linear at any angle up to `most_angle` radians.
    pub fn bake(lens: &Lens, f_number: f64, most_angle: f64) -> Result<Self, GpuError> {
        let ghosts = single_crossing_ghosts(lens)
            .into_par_iter()
            .map(|ghost| tabled(lens, ghost, f_number, most_angle))
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self {
            f_number,
            ghosts: ghosts.into_iter().flatten().collect(),
        })
    }
}

/// A ghost's steps; none for one that is linear enough at all angles, or never lets light through.
fn tabled(
    lens: &Lens,
    ghost: Ghost,
    f_number: f64,
    most_angle: f64,
) -> Result<Option<TabledGhost>, GpuError> {
    let step = |angle: f64| traced(lens, ghost, angle, f_number);
    let first = (0..FIRST_ANGLES).map(|k| most_angle * k as f64 / (FIRST_ANGLES - 1) as f64);
    let departs = first
        .clone()
        .any(|angle| nonlinearity(lens, ghost, angle, f_number).is_none_or(|off| off > LINEAR_ENOUGH));
    if !departs {
        return Ok(None);
    }
    let near_mm = NEAR_ENOUGH * 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
    let mut steps = first.map(step).collect::<Result<Vec<_>, _>>()?;
    // Whether the way after each step may still have to be halved.
    let mut open = vec![true; steps.len() - 1];
    for _ in 0..MOST_HALVINGS {
        let (mut finer, mut still_open) = (vec![steps[0].clone()], Vec::new());
        for (k, pair) in steps.windows(2).enumerate() {
            if open[k] {
                let middle = step(0.5 * (pair[0].angle + pair[1].angle))?;
                let off = match (&middle.light, between(&steps, middle.angle)) {
                    (None, None) => 0.0,
                    (Some(light), Some(guess)) => light.open().distance(&guess),
                    _ => f64::INFINITY,
                };
                if off > near_mm {
                    finer.push(middle);
                    still_open.push(true);
                }
                still_open.push(off > near_mm);
            } else {
                still_open.push(false);
            }
            finer.push(pair[1].clone());
        }
        (steps, open) = (finer, still_open);
    }
    let is_lit = steps.iter().any(|step| step.light.is_some());
    Ok(is_lit.then_some(TabledGhost {
        first: ghost.first,
        second: ghost.second,
        steps,
    }))
}

fn traced(lens: &Lens, ghost: Ghost, angle: f64, f_number: f64) -> Result<Step, GpuError> {
    let d_line = Paraxial::new(lens, D_LINE_UM, None);
    let gap = d_line.sensor_gap_mm();
    let linear = LinearGhost::new(lens, &d_line, ghost, angle, stop_radius(lens, &d_line, f_number));
    let grid = |wavelength_um, [low, high]: [DVec2; 2], side| -> Result<RayGrid, GpuError> {
        let bundle = Bundle {
            ghost: Some(ghost),
            wavelength_um,
            angle,
            low,
            high,
        };
        let mut grids = Tracing::Cpu.grids(lens, gap, &[bundle], side)?;
        Ok(grids.swap_remove(0))
    };
    let all = DVec2::splat(linear.barrel_mm);
    let window = grid(D_LINE_UM, [-all, all], SEARCH_RAYS)?.window(&linear);
    let light = window
        .map(|window| -> Result<Light, GpuError> {
            let [blue, red] = COLOURS_UM.map(|um| grid(um, window, SIDE));
            Ok(Light::packed([&blue?, &red?]))
        })
        .transpose()?;
    let departure = nonlinearity(lens, ghost, angle, f_number).unwrap_or(FAR_OFF);
    Ok(Step {
        angle,
        departure: departure.min(FAR_OFF) as f32,
        light,
    })
}
