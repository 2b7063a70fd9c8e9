//! The sky's tables against an independent path tracer through the same air: every order of scattering, by chance, with nothing
//! tabulated and nothing taken as even. And laws: the sun's light and the daylight change without a jump through a day.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use glam::DVec3;
use rayon::prelude::*;
use rilievo::camera::{daylight, daylight_exposure, white_balance};
use rilievo::space::Sun;
use rilievo::space::atmosphere::{
    Atmosphere, EYE_KM, GROUND_ALBEDO, GROUND_KM, MIE_G, Medium, SkyIrradiance, TOP_KM, mie_phase,
    rayleigh_phase,
};

/// Numbers in 0..1 (splitmix64: Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A direction at a cosine from an axis.
    fn about(&mut self, axis: DVec3, cosine: f64) -> DVec3 {
        let side = axis.any_orthonormal_vector();
        let (sin, cos) = (std::f64::consts::TAU * self.next()).sin_cos();
        let plan = (1.0 - cosine * cosine).max(0.0).sqrt();
        cosine * axis + plan * (cos * side + sin * axis.cross(side))
    }
}

fn ahead(at: DVec3, way: DVec3, radius: f64) -> Option<f64> {
    let (b, c) = (at.dot(way), at.length_squared() - radius * radius);
    let root = (b * b - c).sqrt();
    [-b - root, -b + root].into_iter().find(|t| *t > 1e-6)
}

/// The sun's light at a place, the sun as a point.
fn sunlight(at: DVec3, to_sun: DVec3, channel: usize) -> f64 {
    if ahead(at, to_sun, GROUND_KM).is_some() {
        return 0.0;
    }
    let end = ahead(at, to_sun, TOP_KM).unwrap_or(0.0);
    const STEPS: usize = 96;
    let depth: f64 = (0..STEPS)
        .map(|k| {
            // Short steps first.
            let [a, b] = [k, k + 1].map(|k| end * (k as f64 / STEPS as f64).powi(2));
            (b - a) * Medium::at((at + 0.5 * (a + b) * to_sun).length()).extinction[channel]
        })
        .sum();
    (-depth).exp()
}

/// One path's light.
fn path(random: &mut Random, view: DVec3, to_sun: DVec3, channel: usize) -> f64 {
    let densest = Medium::at(GROUND_KM).extinction[channel];
    let (mut at, mut way) = (DVec3::new(0.0, 0.0, EYE_KM), view);
    let (mut light, mut throughput) = (0.0, 1.0);
    for _ in 0..400 {
        let ground = ahead(at, way, GROUND_KM);
        let end = ground.or_else(|| ahead(at, way, TOP_KM)).unwrap_or(0.0);
        // Woodcock tracking to the next collision.
        let mut t = 0.0;
        let collides = loop {
            t -= (1.0 - random.next()).ln() / densest;
            if t >= end {
                break false;
            }
            if random.next() < Medium::at((at + t * way).length()).extinction[channel] / densest {
                break true;
            }
        };
        if collides {
            at += t * way;
            let medium = Medium::at(at.length());
            throughput *= medium.scattering()[channel] / medium.extinction[channel];
            let is_mie = random.next() < medium.mie / medium.scattering()[channel];
            let phase = if is_mie { mie_phase } else { rayleigh_phase };
            light += throughput * phase(way.dot(to_sun)) * sunlight(at, to_sun, channel);
            let even = 1.0 / (4.0 * std::f64::consts::PI);
            let cosine = if is_mie {
                // Henyey & Greenstein 1941, weighted to Cornette & Shanks.
                let s = (1.0 - MIE_G * MIE_G) / (1.0 - MIE_G + 2.0 * MIE_G * random.next());
                (1.0 + MIE_G * MIE_G - s * s) / (2.0 * MIE_G)
            } else {
                2.0 * random.next() - 1.0
            };
            let drawn = match is_mie {
                true => even * (1.0 - MIE_G * MIE_G) / (1.0 + MIE_G * MIE_G - 2.0 * MIE_G * cosine).powf(1.5),
                false => even,
            };
            throughput *= phase(cosine) / drawn;
            way = random.about(way, cosine);
        } else if let Some(distance) = ground {
            at += distance * way;
            let up = at.normalize();
            at = up * (GROUND_KM + 1e-6);
            throughput *= GROUND_ALBEDO[channel];
            let facing = up.dot(to_sun).max(0.0);
            light += throughput / std::f64::consts::PI * facing * sunlight(at, to_sun, channel);
            let cosine = random.next().sqrt();
            way = random.about(up, cosine);
        } else {
            break;
        }
        // Roulette.
        if throughput < 0.1 {
            if random.next() > 0.5 {
                break;
            }
            throughput *= 2.0;
        }
    }
    light
}

/// Radiance at zenith and over the horizon, away from the sun and beside it, three heights of the sun, three colours.
#[test]
fn the_sky_is_what_paths_through_the_air_give() {
    const PATHS: u64 = 24_000;
    let mut worst: f64 = 0.0;
    for sun_degrees in [60.0_f64, 25.0, 6.0] {
        let altitude = sun_degrees.to_radians();
        let to_sun = DVec3::new(altitude.cos(), 0.0, altitude.sin());
        let sky = Atmosphere::get().sky_view(altitude.sin());
        for (name, azimuth, view_degrees) in [
            ("zenith", 0.0_f64, 90.0_f64),
            ("horizon, opposite", 180.0, 3.0),
            ("aside", 90.0, 20.0),
        ] {
            let (azimuth, view) = (azimuth.to_radians(), view_degrees.to_radians());
            let way = DVec3::new(view.cos() * azimuth.cos(), view.cos() * azimuth.sin(), view.sin());
            let table = sky.radiance(azimuth, view);
            for channel in 0..3 {
                let paths = (0..PATHS).into_par_iter();
                let sums = paths.map(|k| {
                    let light = path(&mut Random(k * 7919 + channel as u64), way, to_sun, channel);
                    [light, light * light]
                });
                let [sum, squares] = sums.reduce(|| [0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
                let mean = sum / PATHS as f64;
                let spread = ((squares / PATHS as f64 - mean * mean) / PATHS as f64).sqrt() / mean;
                let off = table[channel] / mean - 1.0;
                println!(
                    "sun {sun_degrees}, {name}, {}: table {:.5}, paths {mean:.5} (± {:.1} %): {:+.1} %",
                    ["red", "green", "blue"][channel],
                    table[channel],
                    100.0 * spread,
                    100.0 * off
                );
                worst = worst.max(off.abs() - 2.0 * spread);
            }
        }
    }
    println!("worst, less two standard errors: {:.1} %", 100.0 * worst);
    assert!(worst < 0.05, "{worst}");
}

/// 96 steps of a day, sunrise and sunset among them: in a quarter of an hour, in which the light of dusk fades to an eighth, exposed
/// daylight changes by about a stop at most, and nothing turns negative.
#[test]
fn a_day_has_no_jump() {
    let (latitude, declination) = (45_f64.to_radians(), 15_f64.to_radians());
    let exposed: Vec<[f64; 4]> = (0..=96)
        .map(|step| {
            let hour = std::f64::consts::TAU * (f64::from(step) / 96.0 - 0.5);
            let sine = latitude.sin() * declination.sin() + latitude.cos() * declination.cos() * hour.cos();
            let sun = Sun::from_direction(DVec3::new((1.0 - sine * sine).sqrt(), 0.0, sine));
            assert!(sun.irradiance.min_element() >= 0.0);
            let sky = SkyIrradiance::new(&Atmosphere::get().sky_view(sine)).on(DVec3::Z);
            let day = daylight(&sun, sky * rilievo::space::SUN_ABOVE_AIR);
            let luminance = day.dot(DVec3::new(0.2126, 0.7152, 0.0722));
            let balance = white_balance(day);
            assert!(
                balance.iter().all(|factor| (0.5..2.0).contains(factor)),
                "{balance:?}"
            );
            [
                luminance,
                f64::from(daylight_exposure(day)) * (luminance + 0.0013),
                (day.x + 0.004) / (day.z + 0.004),
                f64::from(balance[0] / balance[2]),
            ]
        })
        .collect();
    let [dark, bright] = [exposed[0], exposed[48]];
    println!("midnight {dark:?}, noon {bright:?}");
    assert!(bright[0] > 2.0 && dark[0] < 1e-3);
    for (step, pair) in exposed.windows(2).enumerate() {
        let stops = (pair[1][1] / pair[0][1]).log2().abs();
        assert!(stops < 1.1, "step {step}: {stops} stops of {pair:?}");
        // White follows the light's colour, so that the image's turns less than that, and the same way.
        let [light, white] = [2, 3].map(|k| (pair[1][k] / pair[0][k]).log2());
        let follows = (light + white).abs() <= light.abs() + 1e-6 && light * white <= 1e-9;
        assert!(
            follows,
            "step {step}: the light turns by {light}, white by {white} stops"
        );
    }
}
