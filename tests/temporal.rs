//! A moving view is anti-aliased by what the frames before it showed, and nothing of them is seen where it is no more.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use glam::DVec3;
use rilievo::camera::Camera;
use rilievo::city::City;
use rilievo::gpu::{Gpu, read_texture};
use rilievo::output::Renderer;
use rilievo::scene::TerrainMesh;
use rilievo::space::Sun;
use support::{pinhole, request, sample};

const SIZE: [u32; 2] = [160, 90];
/// Samples of a picture that stands for the truth.
const TRUE_SAMPLES: u32 = 48;

fn opened() -> (Renderer, Sun) {
    let city = City::open(&sample().join("city")).unwrap();
    let renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let sun = Sun::at_time("2026-06-21T16:00:00+02:00", city.manifest().place).unwrap();
    (renderer, sun)
}

/// The image as drawn, RGB, 0 to 1.
fn shown(renderer: &Renderer) -> Vec<[f64; 3]> {
    let bytes: Vec<u8> = read_texture(&renderer.gpu, &renderer.image().unwrap().texture).unwrap();
    bytes
        .chunks_exact(4)
        .map(|rgba| [0, 1, 2].map(|k: usize| f64::from(rgba[k]) / 255.0))
        .collect()
}

fn truth(renderer: &mut Renderer, camera: &Camera, sun: &Sun) -> Vec<[f64; 3]> {
    for sample in 0..TRUE_SAMPLES {
        renderer.frame(&request(camera, sun, SIZE), sample).unwrap();
    }
    shown(renderer)
}

fn off(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>()
}

/// Root mean square difference.
fn error(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(&a, &b)| off(a, b)).sum();
    (sum / (3 * a.len()) as f64).sqrt()
}

/// A flight past roofs and along a street: each frame comes nearer to the many-sample picture of its view than one sample does, and
/// flickers less.
#[test]
fn frames_of_a_flight_are_smooth() {
    let (mut renderer, sun) = opened();
    for (name, most, from, by, look) in [
        (
            "oblique",
            0.65,
            DVec3::new(288_900.0, 4_772_600.0, 330.0),
            DVec3::new(1.1, 0.8, 0.0),
            DVec3::new(0.55, 0.8, -0.3),
        ),
        (
            "street",
            0.9,
            DVec3::new(289_442.0, 4_773_173.0, 231.1),
            DVec3::new(0.12, 0.03, 0.0),
            DVec3::new(0.95, 0.3, 0.05),
        ),
    ] {
        renderer.cut();
        let camera = |frame: u32| {
            let eye = from + by * f64::from(frame);
            pinhole(eye.to_array(), (eye + look).to_array(), 0.8)
        };
        let mut moving = Vec::new();
        for frame in 0..24 {
            renderer
                .moving_frame(&request(&camera(frame), &sun, SIZE))
                .unwrap();
            moving.push(shown(&renderer));
        }
        let (mut with, mut without) = (0.0, 0.0);
        for frame in [11, 15, 19, 23] {
            let truth = truth(&mut renderer, &camera(frame), &sun);
            renderer.frame(&request(&camera(frame), &sun, SIZE), 0).unwrap();
            with += error(&moving[frame as usize], &truth) / 4.0;
            without += error(&shown(&renderer), &truth) / 4.0;
        }
        println!("{name}: off by {with:.4} with the frames before, {without:.4} with one sample");
        assert!(with < most * without, "{name}: {with}, {without}");
    }
}

/// A camera at rest comes to the many-sample picture.
#[test]
fn a_still_view_comes_to_its_mean() {
    let (mut renderer, sun) = opened();
    let camera = pinhole(
        [288_900.0, 4_772_600.0, 400.0],
        [289_180.0, 4_773_000.0, 215.0],
        0.7,
    );
    let truth = truth(&mut renderer, &camera, &sun);
    renderer.frame(&request(&camera, &sun, SIZE), 0).unwrap();
    let one = error(&shown(&renderer), &truth);
    for _ in 0..32 {
        renderer.moving_frame(&request(&camera, &sun, SIZE)).unwrap();
    }
    let shown = shown(&renderer);
    let many = error(&shown, &truth);
    let mean = |image: &[[f64; 3]]| image.iter().flatten().sum::<f64>() / (3 * image.len()) as f64;
    println!(
        "one sample {one:.4}, {many:.4} after 32 frames; mean {:.4} of {:.4}",
        mean(&shown),
        mean(&truth)
    );
    assert!(many < 0.5 * one, "{many}, {one}");
    assert!((mean(&shown) / mean(&truth) - 1.0).abs() < 0.01);
}

/// Difference that nobody sees.
const SLIGHT: f64 = 0.03;

/// What a wall gives free as the camera steps aside shows nothing of the wall, and a turn to elsewhere nothing of the view before.
#[test]
fn nothing_of_what_is_gone_is_seen() {
    let (mut renderer, sun) = opened();
    let look = DVec3::new(0.95, 0.3, 0.02);
    let camera = |at: DVec3, look: DVec3| pinhole(at.to_array(), (at + look).to_array(), 1.0);
    let from = DVec3::new(289_442.0, 4_773_173.0, 231.1);
    let aside = look.cross(DVec3::Z).normalize();
    for (name, next) in [
        ("a step aside", camera(from + 1.5 * aside, look)),
        ("a turn", camera(from, DVec3::new(-0.3, 0.95, 0.05))),
        (
            "high up",
            camera(from + DVec3::new(0.0, 0.0, 300.0), DVec3::new(0.3, 0.3, -1.0)),
        ),
    ] {
        renderer.cut();
        let before = camera(from, look);
        for _ in 0..16 {
            renderer.moving_frame(&request(&before, &sun, SIZE)).unwrap();
        }
        let old = shown(&renderer);
        renderer.moving_frame(&request(&next, &sun, SIZE)).unwrap();
        let moved = shown(&renderer);
        let truth = truth(&mut renderer, &next, &sun);
        // Where the picture became another one: nothing but what single samples of the view show there.
        let mut range: Vec<[[f64; 3]; 2]> = moved.iter().map(|_| [[1.0; 3], [0.0; 3]]).collect();
        for _ in 0..32 {
            renderer.cut();
            renderer.moving_frame(&request(&next, &sun, SIZE)).unwrap();
            for ([least, most], pixel) in range.iter_mut().zip(shown(&renderer)) {
                for k in 0..3 {
                    least[k] = least[k].min(pixel[k]);
                    most[k] = most[k].max(pixel[k]);
                }
            }
        }
        let (mut pixels, mut ghosts) = (0, 0);
        for k in (0..truth.len()).filter(|&k| off(old[k], truth[k]) > 0.06) {
            pixels += 1;
            let is_own = (0..3).all(|c| {
                let [least, most] = range[k];
                (least[c] - SLIGHT..=most[c] + SLIGHT).contains(&moved[k][c])
            });
            ghosts += u32::from(!is_own);
        }
        println!("{name}: {ghosts} of {pixels} changed pixels");
        assert!(pixels > 100, "{name}: {pixels}");
        assert!(
            f64::from(ghosts) < 0.015 * f64::from(pixels),
            "{name}: {ghosts} of {pixels}"
        );
    }
}
