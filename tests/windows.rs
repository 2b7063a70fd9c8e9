//! Pictures drawn in windows: the same as drawn at once.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::sync::Arc;

use glam::DVec3;
use rilievo::camera::flare::{Aperture, Quality};
use rilievo::camera::lens::built_in;
use rilievo::camera::{Camera, LensOptics, Optics};
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::{FlareSettings, FrameRequest, Renderer, Still};
use rilievo::relief::{ReliefMode, ReliefSettings};
use rilievo::scene::TerrainMesh;
use rilievo::space::{Pose, Sun};

/// Of odd sides, so that the last windows are cut.
const SIZE: [u32; 2] = [629, 371];
/// The crops of such windows have 256 pixels.
const WINDOW_PX: u32 = 400;
const SAMPLES: usize = 2;

fn renderer() -> Renderer {
    let city = City::open(&support::sample().join("city")).unwrap();
    Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap()
}

/// A picture drawn at once, and in windows.
fn both(renderer: &mut Renderer, request: &FrameRequest<'_>) -> [Still; 2] {
    let requests = [*request; SAMPLES];
    [4096, WINDOW_PX].map(|max_px| {
        renderer.max_window_px = max_px;
        renderer.still_of(&requests, true).unwrap()
    })
}

/// Fraction of the pixels for which something holds: of all, and of those beside a border between windows.
fn fractions(holds: impl Fn(usize) -> bool) -> [f64; 2] {
    let [mut all, mut border, mut borders] = [0, 0, 0];
    for row in 0..SIZE[1] {
        for column in 0..SIZE[0] {
            let is_beside =
                |at: u32, side: u32| at >= 200 && at < side - 20 && (at % 256 < 2 || at % 256 >= 254);
            let is_border = is_beside(column, SIZE[0]) || is_beside(row, SIZE[1]);
            let does = usize::from(holds((row * SIZE[0] + column) as usize));
            all += does;
            borders += usize::from(is_border);
            border += does * usize::from(is_border);
        }
    }
    assert!(borders > 500);
    [
        all as f64 / f64::from(SIZE[0] * SIZE[1]),
        border as f64 / borders as f64,
    ]
}

/// Windows put triangles' edges and rays elsewhere between two floats: a pixel on an edge may see the other side of it, no more.
fn assert_same(name: &str, [whole, parts]: &[Still; 2]) {
    assert_eq!(whole.rgba.len(), parts.rgba.len());
    let far = |a: f32, b: f32| (a - b).abs() > 1e-3 * a.abs().max(1.0) || a.is_nan() != b.is_nan();
    let other_depth = fractions(|k| far(whole.depth[k], parts.depth[k]));
    let other_id = fractions(|k| whole.ids[k] != parts.ids[k]);
    let code = |still: &Still, k: usize| [0, 1, 2].map(|channel| still.rgba[4 * k + channel]);
    let other_colour = fractions(|k| {
        let (a, b) = (code(whole, k), code(parts, k));
        (0..3).any(|channel| a[channel].abs_diff(b[channel]) > 3)
    });
    let other_light = fractions(|k| {
        let (a, b) = (whole.radiance[k], parts.radiance[k]);
        (0..3).any(|channel| far(a[channel], b[channel]))
    });
    println!(
        "{name}: depth {other_depth:.5?}, id {other_id:.5?}, colour {other_colour:.5?}, light {other_light:.5?}"
    );
    for [all, border] in [other_depth, other_id, other_colour, other_light] {
        assert!(all < 0.002, "{name}: {all}");
        assert!(border < 0.008, "{name}: {border} at the borders");
    }
}

#[test]
fn a_picture_in_windows_is_that_drawn_at_once() {
    let mut renderer = renderer();
    let sun = Sun::from_azimuth_altitude(215.0, 24.0);
    for (name, eye, target) in support::VIEWS {
        let camera = support::pinhole(eye, target, 60_f64.to_radians());
        for mode in [ReliefMode::Exact, ReliefMode::Search] {
            let request = FrameRequest {
                relief: ReliefSettings {
                    mode,
                    ..ReliefSettings::default()
                },
                ..support::request(&camera, &sun, SIZE)
            };
            let stills = both(&mut renderer, &request);
            assert!(stills[0].ids.iter().any(|&id| id != 0), "{name}: no building");
            assert_same(&format!("{name}, {mode:?}"), &stills);
        }
    }
}

#[test]
fn a_picture_through_a_lens_has_its_flare_and_dark_corners_in_windows_too() {
    let mut renderer = renderer();
    let sun = Sun::from_azimuth_altitude(215.0, 12.0);
    let (_, eye, _) = support::VIEWS[1];
    let mut optics = LensOptics::new(Arc::new(built_in("heliar").unwrap().unwrap()), 5.6, [36.0, 24.0]);
    optics.crop_fov_y = Some(30_f64.to_radians());
    let flare = FlareSettings::from_preset(Quality::Low.preset(), Aperture::default());
    let camera = Camera {
        pose: Pose::looking_along(DVec3::from_array(eye), sun.to_sun + DVec3::new(0.1, 0.03, -0.12)),
        optics: Optics::Lens(optics),
    };
    let plain = support::request(&camera, &sun, SIZE);
    let flared = FrameRequest {
        flare: Some(&flare),
        ..plain
    };
    let stills = both(&mut renderer, &flared);
    let [without, _] = both(&mut renderer, &plain);
    let lit = (stills[0].radiance.iter().zip(&without.radiance))
        .filter(|(with, without)| with[1] > 1.1 * without[1]);
    assert!(lit.count() > 2000, "there is no flare to compare");
    assert_same("lens", &stills);
    // And as it was, drawn at once again: a flare that was switched off comes back.
    renderer.max_window_px = 4096;
    let again = renderer.still_of(&[flared; SAMPLES], true).unwrap();
    assert!(again.rgba == stills[0].rgba, "the picture drawn at once changed");
}

/// The flare of an image that has more pixels than a flare may have is that of a small image, enlarged.
#[test]
fn the_flare_of_a_large_image_is_enlarged() {
    let mut renderer = renderer();
    let sun = Sun::from_azimuth_altitude(215.0, 20.0);
    let (_, eye, _) = support::VIEWS[2];
    let optics = LensOptics::new(Arc::new(built_in("heliar").unwrap().unwrap()), 5.6, [36.0, 24.0]);
    let flare = FlareSettings::from_preset(Quality::Low.preset(), Aperture::default());
    let camera = Camera {
        pose: Pose::looking_along(DVec3::from_array(eye), sun.to_sun + DVec3::new(0.06, 0.02, -0.03)),
        optics: Optics::Lens(optics),
    };
    const TIMES: usize = 5;
    // What the lens adds, as the mean of squares of so many pixels.
    let mut added = |size: [u32; 2], times: usize| -> Vec<f64> {
        let plain = support::request(&camera, &sun, size);
        let flared = FrameRequest {
            flare: Some(&flare),
            ..plain
        };
        let [with, without] = [flared, plain].map(|request| support::radiance(&mut renderer, &request, 1));
        let [wide, high] = size.map(|side| side as usize);
        let (columns, rows) = (wide / times, high / times);
        let mut sums = vec![0.0; columns * rows];
        for (k, (with, without)) in with.iter().zip(&without).enumerate() {
            let (column, row) = (k % wide / times, k / wide / times);
            sums[row * columns + column] += f64::from(with[1] - without[1]) / (times * times) as f64;
        }
        sums
    };
    let small = added([1000, 40], 1);
    let large = added([1000 * TIMES as u32, 40 * TIMES as u32], TIMES);
    assert_eq!(small.len(), large.len());
    let total: f64 = small.iter().sum();
    assert!(total > 0.0);
    let off: f64 = small.iter().zip(&large).map(|(a, b)| (a - b).abs()).sum();
    println!("off by {:.4} of the light", off / total);
    assert!(off < 0.05 * total, "{}", off / total);
}
