//! The sun through a lens: one disc, cut by what covers it, its light once.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::sync::Arc;

use glam::DVec3;
use rilievo::camera::flare::{Aperture, Quality};
use rilievo::camera::lens::built_in;
use rilievo::camera::{Camera, LensOptics, Optics};
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::{FlareSettings, FrameRequest, Renderer};
use rilievo::relief::sun_seen_from;
use rilievo::scene::TerrainMesh;
use rilievo::space::{Pose, SOLAR_ANGULAR_RADIUS, Sun};

const SIZE: [u32; 2] = [160, 106];
const SAMPLES: u32 = 48;

/// Suns over the sample city's first eye that a clean edge hides by half.
fn half_hidden(renderer: &Renderer, eye: DVec3) -> Vec<(Sun, f64)> {
    let tiles = &renderer.resident.tiles;
    let mut suns = Vec::new();
    for azimuth_deg in (0..24).map(|k| 15.0 * f64::from(k)) {
        let at = |altitude: f64| {
            let sun = Sun::from_azimuth_altitude(azimuth_deg, altitude.to_degrees());
            let fraction = sun_seen_from(tiles, eye, &sun).visible_fraction;
            (sun, fraction)
        };
        let (mut min, mut max) = (0.08, 1.2);
        if at(min).1 > 0.0 || at(max).1 < 1.0 {
            continue;
        }
        while max - min > 2e-5 {
            let centre = 0.5 * (min + max);
            if at(centre).1 > 0.5 {
                max = centre;
            } else {
                min = centre;
            }
        }
        let is_clean =
            at(max - 1.1 * SOLAR_ANGULAR_RADIUS).1 < 0.01 && at(max + 1.1 * SOLAR_ANGULAR_RADIUS).1 > 0.99;
        if is_clean {
            suns.push(at(max));
        }
    }
    suns
}

/// The picture of a half-hidden sun has that part of a free sun's light that is seen, and what hides it stays dark where the disc would be.
#[test]
fn a_disc_behind_a_roof_is_cut() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    renderer.load_finest().unwrap();
    let (_, eye, _) = support::VIEWS[0];
    let eye = DVec3::from_array(eye);
    let suns = half_hidden(&renderer, eye);
    assert!(suns.len() >= 2, "{} clean edges", suns.len());
    let lens = Arc::new(built_in("nikon").unwrap().unwrap());
    let preset = Quality::Low.preset();
    let mut flare = FlareSettings::from_preset(preset, Aperture::default());
    flare.ghosts = None;
    for (sun, seen) in suns.into_iter().take(3) {
        let mut optics = LensOptics::new(Arc::clone(&lens), 11.0, [36.0, 24.0]);
        optics.crop_fov_y = Some(3.0_f64.to_radians());
        let mut picture = |eye: DVec3, with_flare: bool| {
            let camera = Camera {
                pose: Pose::looking_along(eye, sun.to_sun),
                optics: Optics::Lens(optics.clone()),
            };
            let request = FrameRequest {
                flare: with_flare.then_some(&flare),
                ..support::request(&camera, &sun, SIZE)
            };
            renderer.still(&request, SAMPLES).unwrap();
            let radiance = renderer.radiance(SAMPLES).unwrap();
            let projection = camera.projection(SIZE);
            // By distance from the sun's centre, in its radii.
            let places: Vec<f64> = (0..SIZE[0] * SIZE[1])
                .map(|k| {
                    let ray = projection.ray_direction(k % SIZE[0], k / SIZE[0]);
                    ray.angle_between(sun.to_sun) / SOLAR_ANGULAR_RADIUS
                })
                .collect();
            (radiance, places)
        };
        let green = |(radiance, places): &(Vec<[f32; 3]>, Vec<f64>), most: f64| -> f64 {
            let near = radiance.iter().zip(places).filter(|(_, place)| **place < most);
            near.map(|(rgb, _)| f64::from(rgb[1])).sum()
        };
        let above = eye + 400.0 * DVec3::Z;
        let free = picture(above, true);
        let plain = picture(above, false);
        let half = picture(eye, true);
        // The lens spreads some of the disc's light and keeps all of it.
        let kept = green(&free, 3.5) / green(&plain, 3.5);
        let fraction = green(&half, 3.5) / green(&free, 3.5);
        println!("seen {seen:.4}, in the picture {fraction:.4}; near the disc {kept:.4} of the light");
        assert!((fraction / seen - 1.0).abs() < 0.02, "{fraction} of {seen}");
        assert!((0.85..1.01).contains(&kept), "{kept}");
        // Where it is covered there is what the lens spreads, and no second disc.
        let disc = green(&free, 0.7) / free.1.iter().filter(|place| **place < 0.7).count() as f64;
        let covered: Vec<f64> = half
            .0
            .iter()
            .zip(&half.1)
            .filter(|(_, place)| **place < 0.7)
            .map(|(rgb, _)| f64::from(rgb[1]) / disc)
            .collect();
        let dark = covered.iter().copied().fold(f64::INFINITY, f64::min);
        println!("covered part {dark:.4} of the disc's radiance");
        assert!(dark < 0.08, "{dark}");
    }
}
