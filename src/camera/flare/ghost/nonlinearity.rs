//! How far a ghost is from its linear image.

use glam::DVec2;

use super::linear::{LinearGhost, stop_radius};
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::paraxial::Paraxial;
use crate::camera::path::Ghost;
use crate::camera::trace::{TracedRay, Tracer, beam_direction};

/// Nonlinearity error beyond which a ghost is traced in the blended mode, as a fraction of the sensor's half diagonal.
pub const LINEAR_ENOUGH: f64 = 0.004;

/// Nonlinearity error of a ghost at an angle in radians: the largest distance between traced and paraxial rays
/// that pass stop and barrel, as a fraction of the sensor's half diagonal; or, if that is more, the fraction of the rays that a
/// barrel inside the lens vignettes, or the light that comes in beyond the linear pupil. None when no ray of it passes.
pub fn nonlinearity(lens: &Lens, ghost: Ghost, angle: f64, f_number: f64) -> Option<f64> {
    let paraxial = Paraxial::new(lens, D_LINE_UM, None);
    let tracer = Tracer::new(lens, D_LINE_UM, paraxial.sensor_gap_mm());
    let stop_mm = stop_radius(lens, &paraxial, f_number);
    let linear = LinearGhost::new(lens, &paraxial, ghost, angle, stop_mm);
    let half_diagonal = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
    let size = 13;
    let mut max_error: Option<f64> = None;
    let (mut passing, mut vignetted) = (0_u32, 0_u32);
    for k in 0..size * size {
        let entry = linear.entrance(k % size, k / size, size);
        let is_open = linear.stop(entry).length() <= linear.stop_mm && entry.length() <= linear.barrel_mm;
        let Some(ray) = tracer.trace(Some(ghost), entry, beam_direction(angle)) else {
            vignetted += u32::from(is_open);
            continue;
        };
        vignetted += u32::from(is_open && ray.relative_height > 1.0);
        passing += u32::from(is_open);
        if ray.relative_height <= 1.0 && ray.stop_mm.length() <= linear.stop_mm {
            let off = (ray.sensor_mm - linear.sensor(entry)).length() / half_diagonal;
            max_error = Some(max_error.unwrap_or(0.0).max(off));
        }
    }
    let fraction = f64::from(vignetted) / f64::from(passing.max(1));
    max_error.map(|off| off.max(fraction).max(outer_light(&tracer, ghost, angle, &linear)))
}

/// Rays beyond the linear pupil: directions over half a turn, its ends counted, and radii.
const OUTER_DIRECTIONS: u32 = 5;
const OUTER_RADII: u32 = 32;
/// Radius by the linear pupil's from which light counts as beyond it.
const BEYOND_PUPIL: f64 = 1.25;

/// Entrance beyond the linear pupil that lets light through, by the pupil's area: a strongly curved front bends a ring of it into the
/// iris, of which the matrices know nothing.
pub fn outer_light(tracer: &Tracer<'_>, ghost: Ghost, angle: f64, linear: &LinearGhost) -> f64 {
    use std::f64::consts::PI;
    let pupil_mm = (linear.stop_mm / linear.a[0]).abs().min(linear.barrel_mm);
    let step_mm = linear.barrel_mm / f64::from(OUTER_RADII);
    let mut area_mm2 = 0.0;
    for direction in 0..OUTER_DIRECTIONS {
        let turn = PI * f64::from(direction) / f64::from(OUTER_DIRECTIONS - 1);
        // The other half is this one's mirror image, and shares its ends.
        let is_end = direction == 0 || direction == OUTER_DIRECTIONS - 1;
        let width = PI / f64::from(OUTER_DIRECTIONS - 1) * if is_end { 1.0 } else { 2.0 };
        for ring in 0..OUTER_RADII {
            let radius_mm = (f64::from(ring) + 0.5) * step_mm;
            let entry = radius_mm * DVec2::from_angle(turn);
            if linear.stop(entry).length() <= BEYOND_PUPIL * linear.stop_mm {
                continue;
            }
            let ray = tracer.trace(Some(ghost), entry, beam_direction(angle));
            let passes =
                |ray: TracedRay| ray.relative_height <= 1.0 && ray.stop_mm.length() <= linear.stop_mm;
            if ray.is_some_and(passes) {
                area_mm2 += width * radius_mm * step_mm;
            }
        }
    }
    area_mm2 / (PI * pupil_mm * pupil_mm)
}
