//! The sky as it is seen from near the ground (Hillaire 2020, section 5.3), below the horizon the planet through the air before it.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::medium::{
    EYE_KM, GROUND_ALBEDO, GROUND_KM, Medium, TOP_KM, mie_phase, radius_along, rayleigh_phase, sphere_ahead,
};
use super::multiple_scattering::MultipleScattering;
use super::transmittance::{Transmittance, between};

/// Texels from the sun's azimuth to the opposite one, and from straight below to the zenith: the middle row is level, just above the
/// horizon.
pub const SKY_VIEW_SIZE: [usize; 2] = [32, 97];
const STEPS: usize = 28;

/// The radiance of one direction, by the sun's irradiance above the air.
#[derive(Clone, Copy, Debug, Default)]
pub struct SkyTexel {
    /// Scattered by molecules, more than once, or sent on by the ground.
    pub even: DVec3,
    /// Scattered once by haze: to be multiplied by the phase function, whose peak about the sun no table of this size holds.
    pub mie: DVec3,
}

/// The table.
pub struct SkyView {
    texels: Vec<SkyTexel>,
    sun: f64,
}

/// Place of a direction's altitude in the table, 0 to 1: finer about the horizon. Twin: `sky_place` in `shaders/lib/sky.wgsl`.
fn place_of(altitude: f64) -> f64 {
    0.5 + 0.5 * altitude.signum() * (altitude.abs() / (0.5 * PI)).sqrt()
}

fn altitude_of(place: f64) -> f64 {
    let x = 2.0 * place - 1.0;
    x.signum() * x * x * 0.5 * PI
}

impl SkyView {
    pub(super) fn new(transmittance: &Transmittance, scattering: &MultipleScattering, sun: f64) -> Self {
        let [columns, rows] = SKY_VIEW_SIZE;
        let texel = |k: usize| {
            let azimuth = PI * (k % columns) as f64 / (columns - 1) as f64;
            let altitude = altitude_of((k / columns) as f64 / (rows - 1) as f64);
            along(transmittance, scattering, sun, [azimuth, altitude])
        };
        Self {
            texels: (0..columns * rows).into_par_iter().map(texel).collect(),
            sun,
        }
    }

    /// The texels, row by row from straight below.
    pub fn texels(&self) -> &[SkyTexel] {
        &self.texels
    }

    /// Radiance of a direction by its azimuth from the sun's and its altitude, radians; without the sun's disc.
    pub fn radiance(&self, azimuth: f64, altitude: f64) -> DVec3 {
        let wrapped = azimuth.rem_euclid(2.0 * PI);
        let place = [wrapped.min(2.0 * PI - wrapped) / PI, place_of(altitude)];
        let phase = mie_phase(self.towards_sun(azimuth, altitude));
        let texels = between(SKY_VIEW_SIZE, place);
        let radiance = |&(texel, weight): &(usize, f64)| {
            weight * (self.texels[texel].even + phase * self.texels[texel].mie)
        };
        texels.iter().map(radiance).sum()
    }

    fn towards_sun(&self, azimuth: f64, altitude: f64) -> f64 {
        let sun_across = (1.0 - self.sun * self.sun).max(0.0).sqrt();
        altitude.sin() * self.sun + altitude.cos() * sun_across * azimuth.cos()
    }
}

/// Integrates along a ray.
fn along(
    transmittance: &Transmittance,
    scattering: &MultipleScattering,
    sun: f64,
    [azimuth, altitude]: [f64; 2],
) -> SkyTexel {
    let up = altitude.sin();
    let sun_across = (1.0 - sun * sun).max(0.0).sqrt();
    let towards_sun = up * sun + altitude.cos() * sun_across * azimuth.cos();
    let ground = sphere_ahead(EYE_KM, up, GROUND_KM).filter(|_| up < 0.0);
    let end = ground.or_else(|| sphere_ahead(EYE_KM, up, TOP_KM)).unwrap_or(0.0);
    let mut texel = SkyTexel::default();
    let mut through = DVec3::ONE;
    let mut before = 0.0;
    for k in 0..STEPS {
        // Steps grow with the distance: the air near the eye is the densest.
        let fraction = (k + 1) as f64 / STEPS as f64;
        let past = end * fraction * fraction;
        let (step, distance) = (past - before, 0.5 * (past + before));
        before = past;
        let here = radius_along(EYE_KM, up, distance);
        let medium = Medium::at(here);
        let passes = (-medium.extinction * step).exp();
        let scattered_in = through * (DVec3::ONE - passes) / medium.extinction;
        let sun_here = (EYE_KM * sun + distance * towards_sun) / here;
        let lit = transmittance.sun(here, sun_here);
        texel.even += scattered_in * medium.rayleigh * rayleigh_phase(towards_sun) * lit;
        texel.even +=
            scattered_in * scattering.scattered(&medium, here, (EYE_KM * up + distance) / here, sun_here);
        texel.mie += scattered_in * medium.mie * lit;
        through *= passes;
    }
    if ground.is_some() {
        let sun_here = (EYE_KM * sun + end * towards_sun) / GROUND_KM;
        let direct = transmittance.sun(GROUND_KM, sun_here) * sun_here.max(0.0);
        texel.even += through * GROUND_ALBEDO / PI * (direct + scattering.on_ground(sun_here));
    }
    texel
}
