//! How much light comes through the air to a place from the sun (Hillaire 2020, section 5.2; the table's coordinates are of Bruneton &
//! Neyret 2008, section 4).

use glam::DVec3;

use super::medium::{GROUND_KM, Medium, TOP_KM, radius_along, sphere_ahead};
use crate::space::SOLAR_ANGULAR_RADIUS;

/// Cells along the cosine and along the height.
const SIZE: [usize; 2] = [128, 48];
const STEPS: usize = 40;

/// The table.
pub struct Transmittance {
    texels: Vec<DVec3>,
}

/// Distance from the ground's horizon to the top of the air, km.
fn horizon_km() -> f64 {
    (TOP_KM * TOP_KM - GROUND_KM * GROUND_KM).sqrt()
}

impl Transmittance {
    /// Integrates the air's extinction to its top.
    pub fn new() -> Self {
        let texel = |k: usize| {
            let u = (k % SIZE[0]) as f64 / (SIZE[0] - 1) as f64;
            let v = (k / SIZE[0]) as f64 / (SIZE[1] - 1) as f64;
            let rho = v * horizon_km();
            let radius = (rho * rho + GROUND_KM * GROUND_KM).sqrt();
            let (min, max) = (TOP_KM - radius, rho + horizon_km());
            let distance = min + u * (max - min);
            let cosine = match distance > 0.0 {
                true => (horizon_km().powi(2) - rho * rho - distance * distance) / (2.0 * radius * distance),
                false => 1.0,
            };
            to_top(radius, cosine.clamp(-1.0, 1.0))
        };
        Self {
            texels: (0..SIZE[0] * SIZE[1]).map(texel).collect(),
        }
    }

    /// To the top of the air along a ray that does not meet the ground.
    fn to_top(&self, radius_km: f64, cosine: f64) -> DVec3 {
        let rho = (radius_km * radius_km - GROUND_KM * GROUND_KM).max(0.0).sqrt();
        let distance = sphere_ahead(radius_km, cosine, TOP_KM).unwrap_or(0.0);
        let (min, max) = (TOP_KM - radius_km, rho + horizon_km());
        let place = [(distance - min) / (max - min).max(1e-9), rho / horizon_km()];
        let texels = between(SIZE, place);
        texels
            .iter()
            .map(|&(texel, weight)| weight * self.texels[texel])
            .sum()
    }

    /// The fraction of the sun's light at a place; `cosine`: of the centre of its disc with the zenith. The part of the disc that is
    /// below the horizon is taken off.
    pub fn sun(&self, radius_km: f64, cosine: f64) -> DVec3 {
        let horizon = -(1.0 - (GROUND_KM / radius_km).powi(2)).max(0.0).sqrt();
        let above = (cosine.clamp(-1.0, 1.0).asin() - horizon.asin()) / SOLAR_ANGULAR_RADIUS;
        if above <= -1.0 {
            return DVec3::ZERO;
        }
        // The part of a disc above a line (area of a circular segment).
        let x = above.min(1.0);
        let part = 0.5 + (x * (1.0 - x * x).max(0.0).sqrt() + x.asin()) / std::f64::consts::PI;
        self.to_top(radius_km, cosine.max(horizon)) * part
    }
}

/// By the trapezoid rule.
fn to_top(radius_km: f64, cosine: f64) -> DVec3 {
    let distance = sphere_ahead(radius_km, cosine, TOP_KM).unwrap_or(0.0);
    let step = distance / STEPS as f64;
    let depth: DVec3 = (0..=STEPS)
        .map(|k| {
            let weight = if k == 0 || k == STEPS { 0.5 } else { 1.0 };
            weight * step * Medium::at(radius_along(radius_km, cosine, k as f64 * step)).extinction
        })
        .sum();
    (-depth).exp()
}

/// The four texels of a table about a place, 0 to 1 along each side, and their weights.
pub(super) fn between(size: [usize; 2], at: [f64; 2]) -> [(usize, f64); 4] {
    let cell = |k: usize| {
        let place = at[k].clamp(0.0, 1.0) * (size[k] - 1) as f64;
        let first = (place as usize).min(size[k] - 2);
        (first, place - first as f64)
    };
    let ((x, fx), (y, fy)) = (cell(0), cell(1));
    let first = y * size[0] + x;
    [
        (first, (1.0 - fx) * (1.0 - fy)),
        (first + 1, fx * (1.0 - fy)),
        (first + size[0], (1.0 - fx) * fy),
        (first + size[0] + 1, fx * fy),
    ]
}
