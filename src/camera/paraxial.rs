//! Rays near the axis by 2x2 ray-transfer matrices (KR 10-1465658; Lee & Eisemann 2013, section 3 and Table 1).
//!
//! A ray is (r, u): height above the axis in millimetres, and slope dr/ds along the direction of travel, so that every
//! translation is positive, also backwards. **Sign trap**: refraction met from behind is then `J R⁻¹ J` with
//! `J = diag(1, -1)`, not `R⁻¹`.

use glam::{DMat2, DVec2};

use super::lens::Lens;
use super::path::{Ghost, Step, path};

/// Matrices of one path through the lens.
#[derive(Clone, Copy, Debug)]
pub struct PathMatrices {
    /// From the plane of the first vertex to the stop (its first crossing).
    pub ma: DMat2,
    /// From there to the sensor.
    pub ms: DMat2,
    /// From the first vertex to the sensor: `ms * ma`.
    pub mf: DMat2,
}

/// First-order data of a lens at one wavelength.
#[derive(Clone, Debug)]
pub struct Paraxial {
    /// Media: before the first surface, then after each.
    indices: Vec<f64>,
    /// 1 / radius at each vertex, 1/mm.
    curvatures: Vec<f64>,
    /// Distance to the next surface, the last one's to the sensor, millimetres.
    gaps: Vec<f64>,
    stop: usize,
    /// Effective focal length, millimetres.
    pub efl_mm: f64,
    /// From the last vertex to the focus, millimetres.
    pub bfd_mm: f64,
}

/// A matrix by rows.
fn rows(a: f64, b: f64, c: f64, d: f64) -> DMat2 {
    DMat2::from_cols(DVec2::new(a, c), DVec2::new(b, d))
}

/// T: over a distance.
pub fn translation(distance_mm: f64) -> DMat2 {
    rows(1.0, distance_mm, 0.0, 1.0)
}

/// R: from index `n1` into `n2`, met from the front.
pub fn refraction(n1: f64, n2: f64, curvature: f64) -> DMat2 {
    rows(1.0, 0.0, (n1 - n2) / n2 * curvature, n1 / n2)
}

/// R met from behind, out of `n2` into `n1`: `J R⁻¹ J`.
pub fn refraction_backward(n1: f64, n2: f64, curvature: f64) -> DMat2 {
    let j = rows(1.0, 0.0, 0.0, -1.0);
    j * refraction(n1, n2, curvature).inverse() * j
}

/// L: reflection met from the front.
pub fn reflection(curvature: f64) -> DMat2 {
    rows(1.0, 0.0, 2.0 * curvature, 1.0)
}

/// L met from behind.
pub fn reflection_backward(curvature: f64) -> DMat2 {
    reflection(-curvature)
}

impl Paraxial {
    /// Of a lens at a wavelength in micrometres, with the sensor in its paraxial focus for that wavelength, or at
    /// `sensor_gap_mm` behind the last vertex.
    pub fn new(lens: &Lens, wavelength_um: f64, sensor_gap_mm: Option<f64>) -> Self {
        let mut paraxial = Self {
            indices: lens.indices(wavelength_um),
            curvatures: lens.surfaces.iter().map(|surface| surface.curvature()).collect(),
            gaps: lens.surfaces.iter().map(|surface| surface.thickness_mm).collect(),
            stop: lens.stop,
            efl_mm: 0.0,
            bfd_mm: 0.0,
        };
        let last = paraxial.gaps.len() - 1;
        paraxial.gaps[last] = 0.0;
        let whole = paraxial.matrices(None).mf;
        // A parallel ray (1, 0) leaves as (A, C) and meets the axis after -A / C.
        paraxial.efl_mm = -1.0 / whole.x_axis.y;
        paraxial.bfd_mm = -whole.x_axis.x / whole.x_axis.y;
        paraxial.gaps[last] = sensor_gap_mm.unwrap_or(paraxial.bfd_mm);
        paraxial
    }

    /// From the last vertex to the sensor, millimetres.
    pub fn sensor_gap_mm(&self) -> f64 {
        self.gaps[self.gaps.len() - 1]
    }

    /// Matrices of a ghost; without one, of the image.
    pub fn matrices(&self, ghost: Option<Ghost>) -> PathMatrices {
        let mut ma = DMat2::IDENTITY;
        let mut since = DMat2::IDENTITY;
        let mut past_stop = false;
        let mut before: Option<Step> = None;
        for step in path(self.gaps.len(), ghost) {
            if let Some(before) = before {
                // The gap between two surfaces belongs to the one nearer the front.
                since = translation(self.gaps[before.surface.min(step.surface)]) * since;
            }
            if step.surface == self.stop && !past_stop {
                past_stop = true;
                ma = since;
                since = DMat2::IDENTITY;
            }
            since = self.at(step) * since;
            before = Some(step);
        }
        let ms = translation(self.sensor_gap_mm()) * since;
        PathMatrices { ma, ms, mf: ms * ma }
    }

    fn at(&self, step: Step) -> DMat2 {
        let curvature = self.curvatures[step.surface];
        let (n1, n2) = (self.indices[step.surface], self.indices[step.surface + 1]);
        match (step.reflects, step.forward) {
            (false, true) => refraction(n1, n2, curvature),
            (false, false) => refraction_backward(n1, n2, curvature),
            (true, true) => reflection(curvature),
            (true, false) => reflection_backward(curvature),
        }
    }

    /// Radius of the entrance pupil for a stop of radius `stop_mm`, millimetres.
    pub fn entrance_pupil(&self, stop_mm: f64) -> f64 {
        stop_mm / self.matrices(None).ma.x_axis.x.abs()
    }

    /// Least f-number of a lens: with its stop wide open. None where the stop has no radius.
    pub fn widest_f_number(&self, lens: &Lens) -> Option<f64> {
        let number = self.efl_mm.abs() / (2.0 * self.entrance_pupil(lens.clear_radius(lens.stop)));
        (number.is_finite() && number > 0.0).then_some(number)
    }

    /// Radius of the stop at an f-number, millimetres.
    pub fn stop_radius(&self, f_number: f64) -> f64 {
        0.5 * self.efl_mm.abs() / f_number * self.matrices(None).ma.x_axis.x.abs()
    }
}
