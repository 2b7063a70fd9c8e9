//! Ghosts of the sun's disc: against the mean of many points of it, each drawn on its own.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use glam::{DVec2, DVec3};
use rilievo::camera::flare::{
    Aperture, FlareImager, FlareLight, FlareMode, FlareRequest, GhostParameters, Quality, film_half_mm,
};
use rilievo::camera::lens::built_in;
use rilievo::camera::{auto_exposure, single_crossing_ghosts, tone_mapped};
use rilievo::gpu::Gpu;
use rilievo::space::SOLAR_ANGULAR_RADIUS;

const SIZE: [u32; 2] = [480, 320];
/// Points of the disc.
const POINTS: u32 = 80;

fn psnr(a: &[u8], b: &[u8]) -> f64 {
    let pairs = a.iter().zip(b);
    let square: f64 = pairs.map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2)).sum();
    20.0 * 255_f64.log10() - 10.0 * (square / (0.75 * a.len() as f64)).max(1e-9).log10()
}

/// The whole flare, and the light of it, against points spread over the disc by the golden angle (Vogel 1979).
#[test]
fn the_suns_ghosts_are_the_mean_of_its_points() {
    let gpu = Gpu::open().unwrap();
    let mut imager = FlareImager::new(&gpu);
    let cases = [
        ("heliar", 8.0, 6.0, FlareMode::Blended, 39.0),
        ("heliar", 16.0, 14.0, FlareMode::Exact, 38.0),
        ("nikon", 8.0, 5.0, FlareMode::Blended, 40.0),
        ("tessar", 5.6, 11.0, FlareMode::Blended, 43.0),
        ("itoh", 8.0, 3.0, FlareMode::Paraxial, 45.0),
    ];
    for (name, f_number, angle_deg, mode, least) in cases {
        let lens = Arc::new(built_in(name).unwrap().unwrap());
        let (angle, azimuth) = (f64::to_radians(angle_deg), 0.5_f64);
        let point = FlareRequest {
            f_number,
            aperture: Aperture::default(),
            ghosts: Some(GhostParameters {
                mode,
                ..Quality::Medium.preset().ghosts()
            }),
            starburst: None,
            table: None,
            light: FlareLight::point(angle, azimuth),
            image_half_mm: film_half_mm(&lens, SIZE),
            lens,
        };
        let disc = FlareRequest {
            light: FlareLight {
                angular_radius: SOLAR_ANGULAR_RADIUS,
                ..point.light
            },
            ..point.clone()
        };
        let drawn = imager.draw(&disc, SIZE).unwrap();
        let centre = DVec3::new(
            angle.sin() * azimuth.cos(),
            angle.sin() * azimuth.sin(),
            angle.cos(),
        );
        let right = centre.cross(DVec3::Y).normalize();
        let up = right.cross(centre);
        let mut mean = vec![[0.0_f32; 3]; drawn.radiance.len()];
        for k in 0..POINTS {
            let radius = SOLAR_ANGULAR_RADIUS * ((f64::from(k) + 0.5) / f64::from(POINTS)).sqrt();
            let at = radius * DVec2::from_angle(2.399_963_229_728_653 * f64::from(k));
            let direction = (centre + right * at.x + up * at.y).normalize();
            let [angle, azimuth] = FlareLight::angle_azimuth(direction);
            let light = FlareLight::point(angle, azimuth);
            let image = imager
                .draw(
                    &FlareRequest {
                        light,
                        ..point.clone()
                    },
                    SIZE,
                )
                .unwrap();
            for (sum, rgb) in mean.iter_mut().zip(&image.radiance) {
                *sum = [0, 1, 2].map(|k: usize| sum[k] + rgb[k] / POINTS as f32);
            }
        }
        let exposure = auto_exposure(&mean);
        let near = psnr(
            &tone_mapped(&mean, exposure),
            &tone_mapped(&drawn.radiance, exposure),
        );
        let light = |radiance: &[[f32; 3]]| radiance.iter().flatten().map(|&v| f64::from(v)).sum::<f64>();
        let kept = light(&drawn.radiance) / light(&mean);
        println!("{name} f/{f_number} {angle_deg} {mode:?}: {near:.2} dB, light {kept:.4}");
        assert!(near > least, "{name}: {near} dB");
        assert!((kept - 1.0).abs() < 0.03, "{name}: {kept} of the light");
    }
}

/// A softened ghost has the light of the sharp one: of every lens's ghosts that lie whole on a large film.
#[test]
fn softening_keeps_a_ghosts_light() {
    let gpu = Gpu::open().unwrap();
    let mut imager = FlareImager::new(&gpu);
    let size = [900, 600];
    let (mut checked, mut folded, mut off) = (0, 0, 0);
    for (name, f_number, mode) in [
        ("heliar", 8.0, FlareMode::Exact),
        ("angenieux", 5.6, FlareMode::Exact),
        ("nikon", 11.0, FlareMode::Paraxial),
        ("itoh", 8.0, FlareMode::Exact),
    ] {
        let lens = Arc::new(built_in(name).unwrap().unwrap());
        let mut all = [0.0; 2];
        for ghost in single_crossing_ghosts(&lens) {
            let request = FlareRequest {
                f_number,
                aperture: Aperture::default(),
                ghosts: Some(GhostParameters {
                    mode,
                    rays: 48,
                    only: Some(ghost),
                    ..Quality::Medium.preset().ghosts()
                }),
                starburst: None,
                table: None,
                light: FlareLight::point(0.06, 0.5),
                image_half_mm: film_half_mm(&lens, size).map(|half| 1.5 * half),
                lens: Arc::clone(&lens),
            };
            let [sharp, soft] = [0.0, SOLAR_ANGULAR_RADIUS].map(|angular_radius| {
                let light = FlareLight {
                    angular_radius,
                    ..request.light
                };
                imager
                    .draw(
                        &FlareRequest {
                            light,
                            ..request.clone()
                        },
                        size,
                    )
                    .unwrap()
                    .radiance
            });
            let at_border = |k: usize| {
                let (x, y) = (k % 900, k / 900);
                x.min(899 - x) < 40 || y.min(599 - y) < 40
            };
            let is_whole = [&sharp, &soft].iter().all(|image| {
                let mut border = image.iter().enumerate().filter(|(k, _)| at_border(*k));
                border.all(|(_, rgb)| rgb[1] == 0.0)
            });
            let lit = sharp.iter().filter(|rgb| rgb[1] > 0.0).count();
            // A ghost of few pixels is not drawn well enough sharp to be compared with.
            if !is_whole || lit < 600 {
                continue;
            }
            let sum = |image: &[[f32; 3]]| image.iter().map(|rgb| f64::from(rgb[1])).sum::<f64>();
            let peak = sharp.iter().map(|rgb| f64::from(rgb[1])).fold(0.0, f64::max);
            // Folds are too thin to be drawn well sharp.
            let is_folded = peak > 8.0 * sum(&sharp) / lit as f64;
            let kept = sum(&soft) / sum(&sharp);
            let most = if is_folded { 0.05 } else { 0.03 };
            off += usize::from((kept - 1.0).abs() > 0.01);
            if !is_folded {
                all = [all[0] + sum(&sharp), all[1] + sum(&soft)];
            }
            assert!((kept - 1.0).abs() < most, "{name} {ghost:?}: {kept}");
            folded += usize::from(is_folded);
            checked += 1;
        }
        assert!(
            all[0] == 0.0 || (all[1] / all[0] - 1.0).abs() < 0.01,
            "{name}: {all:?}"
        );
    }
    println!("{checked} ghosts, {folded} of them folded, {off} off by more than 1 %");
    // Where iris and barrel both cut, each is softened as if it were alone.
    assert!(
        checked > 30 && folded * 5 < checked && off * 20 < checked,
        "{checked}, {folded}, {off}"
    );
}
