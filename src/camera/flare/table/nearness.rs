//! How near an interpolated grid of rays is to a traced one.

use glam::DVec2;

use super::knot::{Unpacked, Values};

/// When two grids of a ghost are as good as the same.
pub struct Nearness {
    /// Difference on the sensor.
    pub sensor_mm: f64,
    /// Radius of the iris.
    pub stop_mm: f64,
    /// Radius of what of the entrance the linear image takes.
    pub pupil_mm: f64,
}

/// Differences that are near enough, of heights relative to the barrel and of positions relative to the iris.
const NEAR_EDGE: f64 = 0.05;
/// Lit part of the pupil below which edges are told no better.
const MIN_LIT: f64 = 0.2;

impl Nearness {
    /// What is near enough at an edge, as a fraction of the pupil: less where the ghost is cut to a part of it. `rays` are `count`
    /// spread over a window.
    pub fn edge(
        &self,
        rays: impl Iterator<Item = Option<Values>>,
        [min, max]: [DVec2; 2],
        count: usize,
    ) -> f64 {
        let lit = rays
            .filter(|ray| {
                ray.is_some_and(|values| values[4] <= 1.0 && values[2].hypot(values[3]) <= self.stop_mm)
            })
            .count();
        let area_mm2 = (max - min).element_product() * lit as f64 / count as f64;
        let pupil_mm2 = std::f64::consts::PI * self.pupil_mm.powi(2);
        NEAR_EDGE * (area_mm2 / pupil_mm2).clamp(MIN_LIT, 1.0)
    }

    /// Largest difference of rays that pass in either, in units of what is near enough.
    pub fn off(&self, a: &Unpacked, b: &Unpacked) -> f64 {
        let edge = self.edge(a.colours[0].iter().copied(), a.window, a.colours[0].len());
        let pairs = a.colours.iter().flatten().zip(b.colours.iter().flatten());
        pairs
            .filter(|(a, b)| self.passes(a) || self.passes(b))
            .map(|(a, b)| self.off_ray(a, b, edge))
            .fold(0.0, f64::max)
    }

    /// Whether a ray passes, or nearly.
    pub fn passes(&self, values: &Option<Values>) -> bool {
        values.is_some_and(|values| {
            let stop = DVec2::new(values[2], values[3]);
            values[4] <= 1.0 + NEAR_EDGE && stop.length() <= 1.1 * self.stop_mm
        })
    }

    /// Difference of two rays.
    pub fn off_ray(&self, a: &Option<Values>, b: &Option<Values>, edge: f64) -> f64 {
        let (Some(a), Some(b)) = (a, b) else {
            return f64::INFINITY;
        };
        let on_sensor = (a[0] - b[0]).hypot(a[1] - b[1]) / self.sensor_mm;
        let in_stop = (a[2] - b[2]).hypot(a[3] - b[3]) / (edge * self.stop_mm);
        let height = (a[4] - b[4]).abs() / edge;
        on_sensor.max(in_stop).max(height)
    }
}
