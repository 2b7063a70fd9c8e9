//! The air: Hillaire 2020, table 1; Bruneton 2017. Its haze: Hess, Koepke & Schult 1998.

use std::f64::consts::PI;

use glam::{DVec3, dvec3};

/// Radius of the planet, km.
pub const GROUND_KM: f64 = 6360.0;
/// Radius of the top of its air, km.
pub const TOP_KM: f64 = 6460.0;
/// Radius where the sky is looked at from: 200 m up, km.
pub const EYE_KM: f64 = GROUND_KM + 0.2;
/// Reflectance of the planet: a town's and its fields'.
pub const GROUND_ALBEDO: DVec3 = dvec3(0.30, 0.285, 0.25);
/// Parameter of the Mie phase function: its mean cosine is 0.709, that of clean continental air (Hess, Koepke & Schult 1998).
pub const MIE_G: f64 = 0.647;

/// Per km at the ground; heights of scale, km.
const RAYLEIGH: DVec3 = dvec3(5.802e-3, 13.558e-3, 33.1e-3);
const RAYLEIGH_SCALE_KM: f64 = 8.0;
const MIE_SCALE_KM: f64 = 1.2;
/// Optical depth of haze, and what it scatters of the light that it takes: clean continental air at 550 nm (Hess, Koepke & Schult 1998,
/// BAMS 79(5), table 4). The table of Hillaire has a twelfth of it, clearer than any day over a town.
const HAZE_DEPTH: f64 = 0.064;
const SCATTERED: f64 = 0.972;
/// What haze at the ground takes of light, per km.
pub const HAZE_PER_KM: f64 = HAZE_DEPTH / MIE_SCALE_KM;
/// Ozone: absorption at the height of its layer, half the width of that.
const OZONE: DVec3 = dvec3(0.650e-3, 1.881e-3, 0.085e-3);
const OZONE_KM: f64 = 25.0;
const OZONE_HALF_WIDTH_KM: f64 = 15.0;

/// The air at a place, per km.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Rayleigh scattering.
    pub rayleigh: DVec3,
    /// Mie scattering.
    pub mie: f64,
    /// All that light loses.
    pub extinction: DVec3,
}

impl Medium {
    /// At a distance from the planet's centre, km.
    pub fn at(radius_km: f64) -> Self {
        let height = (radius_km - GROUND_KM).max(0.0);
        let rayleigh = RAYLEIGH * (-height / RAYLEIGH_SCALE_KM).exp();
        let haze = HAZE_PER_KM * (-height / MIE_SCALE_KM).exp();
        let ozone = OZONE * (1.0 - (height - OZONE_KM).abs() / OZONE_HALF_WIDTH_KM).max(0.0);
        Self {
            rayleigh,
            mie: SCATTERED * haze,
            extinction: rayleigh + DVec3::splat(haze) + ozone,
        }
    }

    /// All scattering.
    pub fn scattering(&self) -> DVec3 {
        self.rayleigh + DVec3::splat(self.mie)
    }
}

/// Phase function of Rayleigh scattering, per steradian.
pub fn rayleigh_phase(cosine: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cosine * cosine)
}

/// Phase function of Mie scattering (Cornette & Shanks 1992), per steradian.
pub fn mie_phase(cosine: f64) -> f64 {
    let g2 = MIE_G * MIE_G;
    let scale = 3.0 / (8.0 * PI) * (1.0 - g2) / (2.0 + g2);
    scale * (1.0 + cosine * cosine) / (1.0 + g2 - 2.0 * MIE_G * cosine).powf(1.5)
}

/// Distance to a sphere about the planet's centre along a ray from inside or outside it, km: the first ahead, none without one.
/// `cosine`: of the ray with the zenith.
pub(super) fn sphere_ahead(radius_km: f64, cosine: f64, sphere_km: f64) -> Option<f64> {
    let discriminant = radius_km * radius_km * (cosine * cosine - 1.0) + sphere_km * sphere_km;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let near = -radius_km * cosine - root;
    let far = -radius_km * cosine + root;
    [near, far].into_iter().find(|&distance| distance > 1e-6)
}

/// Radius at a distance along a ray, km.
pub(super) fn radius_along(radius_km: f64, cosine: f64, distance_km: f64) -> f64 {
    (radius_km * radius_km + distance_km * distance_km + 2.0 * radius_km * cosine * distance_km).sqrt()
}
