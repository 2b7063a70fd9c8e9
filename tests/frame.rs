//! The persistent frame: what it makes, and what its lens gives.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rilievo::camera::flare::{Aperture, Quality};
use rilievo::camera::lens::built_in;
use rilievo::camera::{Camera, LensOptics, Optics};
use rilievo::city::City;
use rilievo::gpu::{Band, Gpu, read_texture};
use rilievo::output::{FlareSettings, FrameRequest, Intermediate, Renderer};
use rilievo::scene::TerrainMesh;
use rilievo::space::{Pose, Sun};

const SIZE: [u32; 2] = [96, 54];

fn renderer() -> Renderer {
    let city = City::open(&support::sample().join("city")).unwrap();
    Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap()
}

/// A camera that looks at a low sun through a lens.
fn through_a_lens(azimuth_deg: f64) -> (Camera, Sun, FlareSettings) {
    let sun = Sun::from_azimuth_altitude(azimuth_deg, 12.0);
    let (_, eye, _) = support::VIEWS[1];
    let lens = Arc::new(built_in("tessar").unwrap().unwrap());
    let camera = Camera {
        pose: Pose::looking_along(eye.into(), sun.to_sun - 0.15 * glam::DVec3::Z),
        optics: Optics::Lens(LensOptics::new(lens, 8.0, [36.0, 24.0])),
    };
    let flare = FlareSettings::from_preset(Quality::Low.preset(), Aperture::default());
    (camera, sun, flare)
}

/// A second frame of a view makes nothing on the device, through a lens as well; nor does a moved camera or sun, of which the tiles
/// are resident.
#[test]
fn a_second_frame_makes_no_resource_of_the_device() {
    let mut renderer = renderer();
    let (camera, sun, flare) = through_a_lens(250.0);
    let request = FrameRequest {
        flare: Some(&flare),
        ..support::request(&camera, &sun, SIZE)
    };
    let (moved_camera, moved_sun, _) = through_a_lens(262.0);
    let moved = FrameRequest {
        camera: &moved_camera,
        sun: &moved_sun,
        ..request
    };
    renderer.prepare(&moved).unwrap();
    let before = renderer.gpu.creations();
    renderer.frame(&request, 0).unwrap();
    let first = renderer.gpu.creations();
    assert!(first > before, "the first frame makes its targets");
    for sample in 0..5 {
        renderer.frame(&request, sample).unwrap();
    }
    assert_eq!(renderer.gpu.creations(), first, "the same view");
    renderer.frame(&moved, 0).unwrap();
    assert_eq!(renderer.gpu.creations(), first, "another view and sun");
    let other_size = FrameRequest {
        size: [64, 36],
        ..moved
    };
    renderer.frame(&other_size, 0).unwrap();
    let second = renderer.gpu.creations();
    assert!(second > first, "the count counts");
    for request in [&moved, &other_size, &request] {
        renderer.frame(request, 0).unwrap();
    }
    assert_eq!(renderer.gpu.creations(), second, "back at a size drawn before");
    renderer.gpu.wait().unwrap();
}

/// A frame drawn a band at a time is the frame drawn at once, to the last bit, and so are its second samples.
#[test]
fn bands_make_the_whole_frame() {
    let mut renderer = renderer();
    let (camera, sun, flare) = through_a_lens(250.0);
    let request = FrameRequest {
        flare: Some(&flare),
        ..support::request(&camera, &sun, SIZE)
    };
    let image = |renderer: &Renderer| {
        read_texture::<[u8; 4]>(&renderer.gpu, &renderer.image().unwrap().texture).unwrap()
    };
    let mut whole = Vec::new();
    for sample in 0..2 {
        renderer.frame(&request, sample).unwrap();
        whole.push(image(&renderer));
    }
    assert!(whole[0] != whole[1], "the samples differ");
    for (sample, whole) in (0..).zip(&whole) {
        for index in 0..5 {
            let band = Band { index, count: 5 };
            renderer.frame_band(&request, sample, band).unwrap();
        }
        assert!(image(&renderer) == *whole, "sample {sample}");
    }
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The count above counts all: nothing outside `src/gpu` makes a resource behind its back.
#[test]
fn only_the_gpu_module_makes_resources() {
    let mut files = Vec::new();
    rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
    let mut checked = 0;
    for file in files {
        if file.components().any(|part| part.as_os_str() == "gpu") {
            continue;
        }
        let text = fs::read_to_string(&file).unwrap();
        let dense: String = text.split_whitespace().collect();
        for (index, _) in dense.match_indices("device.create_") {
            let rest = &dense[index + "device.".len()..];
            assert!(
                rest.starts_with("create_command_encoder"),
                "{}: {}",
                file.display(),
                &rest[..40.min(rest.len())]
            );
            checked += 1;
        }
    }
    assert!(checked >= 3, "the test found only {checked} calls");
}

/// A lens gives the field of view of its focal length on its sensor: 2 atan(h / 2 f), h what the image's proportions leave of it.
#[test]
fn the_lens_gives_the_field_of_view() {
    for (name, focal_mm) in [("heliar", 99.235_796_f64), ("heliar-example-1", 100.019_029)] {
        let lens = Arc::new(built_in(name).unwrap().unwrap());
        let camera = |sensor_mm| Camera {
            pose: Pose::looking_along(glam::DVec3::ZERO, glam::DVec3::Y),
            optics: Optics::Lens(LensOptics::new(Arc::clone(&lens), 8.0, sensor_mm)),
        };
        // 3:2 takes the whole of 36 x 24 mm, 16:9 its width, 1:1 its height.
        for (size, height_mm) in [([300, 200], 24.0), ([1280, 720], 20.25), ([500, 500], 24.0)] {
            let expected = 2.0 * (0.5 * height_mm / focal_mm).atan();
            let found = camera([36.0, 24.0]).fov_y(size);
            assert!(
                (found - expected).abs() < 1e-7,
                "{name}, {size:?}: {found} for {expected}"
            );
        }
        let medium = camera([54.0, 40.0]).fov_y([400, 300]);
        assert!((medium - 2.0 * (20.0 / focal_mm).atan()).abs() < 1e-7);
    }
}

/// Every intermediate image can be looked at, and shows something of its own.
#[test]
fn every_intermediate_image_can_be_looked_at() {
    use clap::ValueEnum;
    let mut renderer = renderer();
    let mut seen: Vec<Vec<u8>> = Vec::new();
    let (_, eye, target) = support::VIEWS[1];
    let town = support::pinhole(eye, target, 1.0);
    let (at_the_sun, sun, flare) = through_a_lens(250.0);
    for &which in Intermediate::value_variants() {
        let camera = match which {
            Intermediate::Flare => &at_the_sun,
            _ => &town,
        };
        let request = FrameRequest {
            flare: Some(&flare),
            ..support::request(camera, &sun, SIZE)
        };
        renderer.frame(&request, 0).unwrap();
        let image = renderer.debug_image(which).unwrap();
        assert_eq!(image.len(), (4 * SIZE[0] * SIZE[1]) as usize, "{which:?}");
        let is_plain = image.chunks_exact(4).all(|pixel| pixel == &image[..4]);
        assert!(!is_plain, "{which:?} is all of one colour");
        seen.push(image);
    }
    seen.sort();
    seen.dedup();
    assert!(
        seen.len() + 1 >= Intermediate::value_variants().len(),
        "two images are the same"
    );
}
