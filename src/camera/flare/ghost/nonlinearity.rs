//! How far a ghost is from its linear image.

use super::linear::{LinearGhost, stop_radius};
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::paraxial::Paraxial;
use crate::camera::path::Ghost;
use crate::camera::trace::{Tracer, beam_direction};

/// Nonlinearity error beyond which a ghost is traced in the blended mode, as a fraction of the sensor's half diagonal.
pub const LINEAR_ENOUGH: f64 = 0.004;

/// Nonlinearity error of a ghost at an angle in radians: the largest distance between traced and paraxial rays
/// that pass stop and barrel, as a fraction of the sensor's half diagonal; or, if that is more, the fraction of the rays that a
/// barrel inside the lens vignettes. None when no ray passes.
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
    max_error.map(|off| off.max(fraction))
}
