//! The shape of the opening: blades, rounding, rotation.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// An iris.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Aperture {
    /// Blades; fewer than 3 are a circle.
    pub blades: u32,
    /// 0 = straight edges, 1 = a circle.
    pub rounding: f64,
    /// Rotation of the first vertex from +x, radians.
    pub rotation: f64,
    /// Specks and scratches on the glass; they show in the starburst.
    pub dirt: u32,
}

impl Default for Aperture {
    fn default() -> Self {
        Self {
            blades: 8,
            rounding: 0.04,
            rotation: 0.2,
            dirt: 0,
        }
    }
}

impl Aperture {
    /// Whether another opens in the same shape, dirt apart.
    pub fn has_shape_of(&self, other: &Self) -> bool {
        Self { dirt: 0, ..*self } == Self { dirt: 0, ..*other }
    }

    /// Distance from the centre to the edge in the direction of `at`, as a fraction of the circle through the vertices.
    pub fn edge(&self, at: DVec2) -> f64 {
        if self.blades < 3 {
            return 1.0;
        }
        let half_sector = std::f64::consts::PI / f64::from(self.blades);
        let angle = (at.y.atan2(at.x) - self.rotation).rem_euclid(2.0 * half_sector) - half_sector;
        let straight = half_sector.cos() / angle.cos();
        straight + (1.0 - straight) * self.rounding
    }

    /// Light that passes, 0 or 255 with an edge of one texel, row by row from -y; the image of `size` x `size` texels spans
    /// `extent` times the stop's radius from its centre.
    pub fn mask(&self, size: u32, extent: f64) -> Vec<u8> {
        let texel = 2.0 * extent / f64::from(size);
        (0..size * size)
            .map(|k| {
                let position = |index: u32| (f64::from(index) + 0.5) * texel - extent;
                let at = DVec2::new(position(k % size), position(k / size));
                let inside = (self.edge(at) - at.length()) / texel + 0.5;
                (inside.clamp(0.0, 1.0) * 255.0).round() as u8
            })
            .collect()
    }
}
