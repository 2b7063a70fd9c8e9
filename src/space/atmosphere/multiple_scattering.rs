//! Light scattered more than once (Hillaire 2020, section 5.5). The paper takes it as even in all directions and a place's surroundings
//! as like the place itself, and sums all orders at once; near the horizon that is a tenth too dark. Here the orders are transported
//! one after the other (as Bruneton & Neyret 2008 do, section 2), what the last one leaves is a geometric series, and of the directions
//! that light comes from two moments are kept: how much more of it comes from above, and from the horizon.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::medium::{
    GROUND_ALBEDO, GROUND_KM, Medium, TOP_KM, mie_phase, radius_along, rayleigh_phase, sphere_ahead,
};
use super::transmittance::{Transmittance, between};

/// Cells along the sun's cosine and along the height.
const SIZE: [usize; 2] = [32, 12];
/// Directions from a place: rings of equal solid angle, and spokes over half a turn (the other half is the same).
const DIRECTIONS: [usize; 2] = [12, 4];
const STEPS: usize = 20;
/// Orders that are transported, from the second on.
const ORDERS: usize = 3;

/// What scattering more than once adds, by the sun's irradiance above the air.
pub struct MultipleScattering {
    orders: Orders,
}

/// Radiance times 1, times the cosine with the zenith, and times its second Legendre polynomial, each the mean over all directions.
type Moments = [DVec3; 3];

/// Means of the first two Legendre polynomials over the phase function of haze (Cornette & Shanks 1992) for [`super::MIE_G`].
const MIE_MOMENTS: [f64; 2] = [0.7092, 0.5156];
/// The second of Rayleigh scattering.
const RAYLEIGH_MOMENT: f64 = 0.1;

fn legendre2(cosine: f64) -> f64 {
    1.5 * cosine * cosine - 0.5
}

/// Light of one order of scattering, or of several.
struct Orders {
    /// Means from all round, by the sun's cosine and the height.
    round: Vec<Moments>,
    /// Irradiance of level ground, by the sun's cosine.
    on_ground: Vec<DVec3>,
}

impl MultipleScattering {
    /// Transports order after order.
    pub fn new(transmittance: &Transmittance) -> Self {
        let single = Orders::transported(transmittance, None);
        let mut sum = Orders {
            round: single.round.clone(),
            on_ground: single.on_ground.clone(),
        };
        let mut last = single;
        for order in 0..ORDERS {
            let next = Orders::transported(transmittance, Some(&last));
            // The last one stands for all after it too.
            let tail = |next: DVec3, last: DVec3| {
                let ratio = (next / last.max(DVec3::splat(1e-30))).clamp(DVec3::ZERO, DVec3::splat(0.9));
                if order + 1 == ORDERS {
                    DVec3::ONE / (DVec3::ONE - ratio)
                } else {
                    DVec3::ONE
                }
            };
            for (sum, (next, last)) in sum.round.iter_mut().zip(next.round.iter().zip(&last.round)) {
                let tail = tail(next[0], last[0]);
                *sum = std::array::from_fn(|k| sum[k] + next[k] * tail);
            }
            for (sum, (next, last)) in sum
                .on_ground
                .iter_mut()
                .zip(next.on_ground.iter().zip(&last.on_ground))
            {
                *sum += *next * tail(*next, *last);
            }
            last = next;
        }
        Self { orders: sum }
    }

    /// What the air at a place scatters, per km, of light that was scattered before or sent on by the ground. `up`: cosine of the view
    /// with the zenith there; `sun`: the sun's.
    pub fn scattered(&self, medium: &Medium, radius_km: f64, up: f64, sun: f64) -> DVec3 {
        self.orders.scattered(medium, radius_km, up, sun)
    }

    /// Irradiance of level ground by the sky.
    pub fn on_ground(&self, cosine: f64) -> DVec3 {
        self.orders.on_ground_at(cosine)
    }
}

/// Finer about the horizon, where dusk is.
fn cosine_of(place: f64) -> f64 {
    let x = 2.0 * place - 1.0;
    x.signum() * x * x
}

fn place_of(cosine: f64) -> f64 {
    0.5 + 0.5 * cosine.signum() * cosine.abs().sqrt()
}

impl Orders {
    /// The next order after `before`; after the sun's own light where there is none.
    fn transported(transmittance: &Transmittance, before: Option<&Self>) -> Self {
        let texel = |k: usize| {
            let sun = cosine_of((k % SIZE[0]) as f64 / (SIZE[0] - 1) as f64);
            let height = (k / SIZE[0]) as f64 / (SIZE[1] - 1) as f64;
            let radius = GROUND_KM + 0.001 + height * height * (TOP_KM - GROUND_KM - 0.002);
            all_round(transmittance, before, radius, sun)
        };
        let texels: Vec<(Moments, DVec3)> = (0..SIZE[0] * SIZE[1]).into_par_iter().map(texel).collect();
        Self {
            round: texels.iter().map(|texel| texel.0).collect(),
            on_ground: texels[..SIZE[0]].iter().map(|texel| texel.1).collect(),
        }
    }

    fn scattered(&self, medium: &Medium, radius_km: f64, up: f64, sun: f64) -> DVec3 {
        let height = ((radius_km - GROUND_KM) / (TOP_KM - GROUND_KM)).clamp(0.0, 1.0);
        let place = [place_of(sun), height.sqrt()];
        let [mean, first, second] = between(SIZE, place)
            .iter()
            .fold([DVec3::ZERO; 3], |sum, &(texel, weight)| {
                std::array::from_fn(|k| sum[k] + weight * self.round[texel][k])
            });
        // Of an expansion in Legendre polynomials the terms to the second order.
        let second = second * legendre2(up);
        let rayleigh = mean + 5.0 * RAYLEIGH_MOMENT * second;
        let mie = mean + 3.0 * MIE_MOMENTS[0] * up * first + 5.0 * MIE_MOMENTS[1] * second;
        medium.rayleigh * rayleigh + medium.mie * mie.max(DVec3::ZERO)
    }

    fn on_ground_at(&self, cosine: f64) -> DVec3 {
        let place = place_of(cosine) * (SIZE[0] - 1) as f64;
        let first = (place as usize).min(SIZE[0] - 2);
        self.on_ground[first].lerp(self.on_ground[first + 1], place - first as f64)
    }
}

/// Means from all round, and irradiance of a level surface.
fn all_round(
    transmittance: &Transmittance,
    before: Option<&Orders>,
    radius_km: f64,
    sun: f64,
) -> (Moments, DVec3) {
    let (mut round, mut on_level) = ([DVec3::ZERO; 3], DVec3::ZERO);
    let [rings, spokes] = DIRECTIONS;
    let sun_sine = (1.0 - sun * sun).max(0.0).sqrt();
    for ring in 0..rings {
        let up = 1.0 - 2.0 * (ring as f64 + 0.5) / rings as f64;
        let across = (1.0 - up * up).sqrt();
        for spoke in 0..spokes {
            let azimuth = PI * (spoke as f64 + 0.5) / spokes as f64;
            let towards_sun = up * sun + across * sun_sine * azimuth.cos();
            let radiance = along(transmittance, before, (radius_km, up), (sun, towards_sun));
            let polynomials = [1.0, up, legendre2(up)];
            round = std::array::from_fn(|k| round[k] + radiance * polynomials[k]);
            on_level += radiance * up.max(0.0);
        }
    }
    let count = (rings * spokes) as f64;
    (round.map(|sum| sum / count), on_level * 4.0 * PI / count)
}

/// Radiance along a ray of the order after `before`. `ray`: radius of its start and cosine with the zenith; `sun`: the sun's cosine
/// there, and with the ray.
fn along(transmittance: &Transmittance, before: Option<&Orders>, ray: (f64, f64), sun: (f64, f64)) -> DVec3 {
    let (radius, up) = ray;
    let ground = sphere_ahead(radius, up, GROUND_KM).filter(|_| up < 0.0);
    let end = ground.or_else(|| sphere_ahead(radius, up, TOP_KM)).unwrap_or(0.0);
    let (mut radiance, mut through, mut past) = (DVec3::ZERO, DVec3::ONE, 0.0);
    for k in 0..STEPS {
        // Short steps first.
        let begin = past;
        past = end * ((k + 1) as f64 / STEPS as f64).powi(2);
        let (step, distance) = (past - begin, 0.5 * (past + begin));
        let here = radius_along(radius, up, distance);
        let medium = Medium::at(here);
        // What a step of even air scatters into the ray (the paper's section 5.2, after Hillaire 2015).
        let passes = (-medium.extinction * step).exp();
        let scattered_in = through * (DVec3::ONE - passes) / medium.extinction;
        let sun_here = (radius * sun.0 + distance * sun.1) / here;
        radiance += scattered_in
            * match before {
                None => {
                    let phases =
                        medium.rayleigh * rayleigh_phase(sun.1) + DVec3::splat(medium.mie * mie_phase(sun.1));
                    phases * transmittance.sun(here, sun_here)
                }
                Some(before) => before.scattered(&medium, here, (radius * up + distance) / here, sun_here),
            };
        through *= passes;
    }
    if ground.is_some() {
        let sun_here = (radius * sun.0 + end * sun.1) / GROUND_KM;
        let lit = match before {
            None => transmittance.sun(GROUND_KM, sun_here) * sun_here.max(0.0),
            Some(before) => before.on_ground_at(sun_here),
        };
        radiance += through * GROUND_ALBEDO / PI * lit;
    }
    radiance
}
