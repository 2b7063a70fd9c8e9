//! Vignetting: by its law, and in the picture.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::sync::Arc;

use rilievo::camera::lens::{BUILT_IN, built_in};
use rilievo::camera::{Camera, LensOptics, Optics, Vignetting};
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::{FrameRequest, Renderer};
use rilievo::scene::TerrainMesh;
use rilievo::space::Sun;

const SENSOR: [f64; 2] = [36.0, 24.0];

/// Stopped down, no barrel cuts near the axis: what is left is the cosine to the fourth, by how the pupil looks from aside. Wide open
/// the corner is darker than the centre, too.
#[test]
fn stopped_down_a_lens_darkens_by_the_cosine() {
    for (name, _) in BUILT_IN {
        let lens = Arc::new(built_in(name).unwrap().unwrap());
        let of = |f_number| Vignetting::new(&LensOptics::new(Arc::clone(&lens), f_number, SENSOR));
        let (small, wide) = (of(16.0), of(4.5));
        let focal_mm = LensOptics::new(Arc::clone(&lens), 16.0, SENSOR).focal_mm;
        assert!((small.at(0.0) - 1.0).abs() < 1e-6);
        let r_mm = 0.4 * small.corner_mm;
        let cosine = (r_mm / focal_mm).atan().cos().powi(4) as f32;
        assert!(
            (small.at(r_mm) / cosine - 1.0).abs() < 0.1,
            "{name}: {} and {cosine}",
            small.at(r_mm)
        );
        // A picture can be taken with it, to the corners.
        for vignetting in [&small, &wide] {
            let corner = vignetting.at(vignetting.corner_mm);
            assert!((0.03..1.1).contains(&corner), "{name}: {corner}");
        }
        println!(
            "{name}: corner {:.3} at f/16, {:.3} at f/4.5",
            small.at(small.corner_mm),
            wide.at(wide.corner_mm)
        );
    }
}

/// Through a lens the picture is that of a pinhole, darkened so.
#[test]
fn a_picture_through_a_lens_is_darker_at_its_corners() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let size = [96, 64];
    let (_, eye, target) = support::VIEWS[1];
    let optics = LensOptics::new(Arc::new(built_in("tessar").unwrap().unwrap()), 4.0, SENSOR);
    let half_mm = optics.image_half_mm(size);
    let vignetting = Vignetting::new(&optics);
    let pinhole = support::pinhole(eye, target, 2.0 * (half_mm[1] / optics.focal_mm).atan());
    let through = Camera {
        pose: pinhole.pose,
        optics: Optics::Lens(optics),
    };
    let sun = Sun::from_azimuth_altitude(200.0, 50.0);
    let mut radiance = |camera: &Camera| {
        let request: FrameRequest<'_> = support::request(camera, &sun, size);
        let still = renderer.still_of(&[request], true).unwrap();
        (still.radiance, still.rgba)
    };
    let ((plain, plain_codes), (seen, seen_codes)) = (radiance(&pinhole), radiance(&through));
    let mut off = 0;
    for (k, (plain, seen)) in plain.iter().zip(&seen).enumerate() {
        let (x, y) = ((k % 96) as f64 + 0.5 - 48.0, (k / 96) as f64 + 0.5 - 32.0);
        let expected = vignetting.at(x.hypot(y) * 2.0 * half_mm[1] / 64.0);
        off += usize::from((seen[1] / plain[1] / expected - 1.0).abs() > 0.02);
    }
    assert!(off < 60, "{off} of {} pixels", plain.len());
    // The display's image too: the four corners are darker.
    let corners = [0, 95, 96 * 63, 96 * 64 - 1].map(|k: usize| 4 * k);
    assert!(vignetting.at(vignetting.corner_mm) < 0.8);
    for k in corners {
        assert!(
            seen_codes[k] < plain_codes[k],
            "{} and {}",
            seen_codes[k],
            plain_codes[k]
        );
    }
}
