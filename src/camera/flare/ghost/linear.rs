//! A ghost by its matrices: the effective pupil and the linear image (KR 10-1465658).

use glam::DVec2;

use super::softness::Softness;
use crate::camera::lens::Lens;
use crate::camera::paraxial::Paraxial;
use crate::camera::path::Ghost;

/// Radius of a softened iris' edge, in radii of the iris, up to which ghosts are softened in the iris.
pub const MAX_SOFTNESS: f64 = 0.75;

/// One ghost in one colour by its matrices.
pub struct LinearGhost {
    /// First row of `ma`: height in the stop per entrance height and per slope.
    pub a: [f64; 2],
    /// First row of `mf`, likewise on the sensor.
    pub f: [f64; 2],
    /// Slope of the beam of light.
    pub slope: DVec2,
    /// Radius of the iris, millimetres.
    pub stop_mm: f64,
    /// Radius of the front, millimetres.
    pub barrel_mm: f64,
    /// Centre of the part of the entrance that is drawn, millimetres.
    pub centre: DVec2,
    /// Half its size, millimetres.
    pub half: DVec2,
    /// Centre and half size of its flare quad in the entrance, millimetres.
    pub quad: [DVec2; 2],
}

impl LinearGhost {
    /// For a beam at an angle, radians, and an iris of radius `stop_mm`.
    pub fn new(lens: &Lens, paraxial: &Paraxial, ghost: Ghost, angle: f64, stop_mm: f64) -> Self {
        let matrices = paraxial.matrices(Some(ghost));
        let a = [matrices.ma.x_axis.x, matrices.ma.y_axis.x];
        let f = [matrices.mf.x_axis.x, matrices.mf.y_axis.x];
        let slope = DVec2::new(angle.tan(), 0.0);
        let barrel_mm = barrel_radius(lens, paraxial);
        // The effective pupil, r_e = (±r_a - Ma12 θ) / Ma11: what the stop lets through, seen from the front; of it what
        // the barrel lets in.
        let pupil = -a[1] / a[0] * slope;
        let half_extent = DVec2::splat((stop_mm / a[0]).abs());
        let min = (pupil - half_extent).max(DVec2::splat(-barrel_mm));
        let max = (pupil + half_extent).min(DVec2::splat(barrel_mm));
        let [centre, half] = [0.5 * (min + max), 0.5 * (max - min)];
        Self {
            a,
            f,
            slope,
            stop_mm,
            barrel_mm,
            centre,
            half,
            quad: [centre, half],
        }
    }

    /// The same with a flare quad that a softened ghost does not outgrow.
    pub fn softened(self, softness: &Softness) -> Self {
        let grown = |radius: f64| 1.0 + radius.min(MAX_SOFTNESS);
        let barrel = DVec2::splat(self.barrel_mm * grown(softness.front));
        let half = DVec2::splat((self.stop_mm / self.a[0]).abs() * grown(softness.stop));
        let pupil = -self.a[1] / self.a[0] * self.slope;
        let (min, max) = ((pupil - half).max(-barrel), (pupil + half).min(barrel));
        let quad = [0.5 * (min + max), 0.5 * (max - min)];
        Self { quad, ..self }
    }

    /// Whether more of the ghost's edge is the front's than the iris's: the pupil is wider than the front.
    pub fn is_front_bound(&self) -> bool {
        (self.stop_mm / self.a[0]).abs() > self.barrel_mm
    }

    /// The same with a flare quad over the whole front of the lens.
    pub fn with_whole_entrance(self) -> Self {
        let quad = [DVec2::ZERO, DVec2::splat(self.barrel_mm).max(self.quad[1])];
        Self { quad, ..self }
    }

    /// Nothing of the pupil lies within the barrel.
    pub fn is_shut(&self) -> bool {
        self.half.x <= 0.0 || self.half.y <= 0.0 || !self.half.is_finite()
    }

    /// Point of a grid of `size` x `size` points over the drawn part.
    pub fn entrance(&self, column: usize, row: usize, size: usize) -> DVec2 {
        let fraction = |index: usize| 2.0 * index as f64 / (size - 1) as f64 - 1.0;
        self.centre + self.half * DVec2::new(fraction(column), fraction(row))
    }

    /// On the sensor, millimetres.
    pub fn sensor(&self, entry: DVec2) -> DVec2 {
        self.f[0] * entry + self.f[1] * self.slope
    }

    /// In the stop, millimetres.
    pub fn stop(&self, entry: DVec2) -> DVec2 {
        self.a[0] * entry + self.a[1] * self.slope
    }
}

/// Radius of the stop at an f-number, no wider than it opens, millimetres.
pub fn stop_radius(lens: &Lens, paraxial: &Paraxial, f_number: f64) -> f64 {
    paraxial.stop_radius(f_number).min(lens.clear_radius(lens.stop))
}

/// Radius that the front of the lens lets in, millimetres.
pub fn barrel_radius(lens: &Lens, paraxial: &Paraxial) -> f64 {
    let front = lens.clear_radius(0);
    if front.is_finite() {
        front
    } else {
        1.5 * paraxial.entrance_pupil(lens.clear_radius(lens.stop).min(0.5 * paraxial.efl_mm.abs()))
    }
}
