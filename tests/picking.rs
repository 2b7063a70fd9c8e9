//! What is under a pixel: the CPU twin of the traversal, on the tiles that a window has, against the independent ray caster.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::path::{Path, PathBuf};

use glam::DVec2;
use rilievo::camera::Camera;
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::Renderer;
use rilievo::relief::pick;
use rilievo::scene::TerrainMesh;
use rilievo::space::{Pose, Sun};
use support::raycaster::{Raycaster, Truth};

const SIZE: [u32; 2] = [1280, 720];
/// Views of a city, and pixels of each.
const VIEWS: u32 = 20;
const PIXELS: u32 = 100;

/// Radical inverse of Halton's sequence (1960).
fn halton(mut index: u32, base: u32) -> f64 {
    let (mut value, mut part) = (0.0, 1.0);
    while index > 0 {
        part /= f64::from(base);
        value += f64::from(index % base) * part;
        index /= base;
    }
    value
}

/// Random pixels of random views over the part of a city that has buildings.
fn picks_are_true(name: &str, city: &Path, caster: &Raycaster) {
    let city = City::open(city).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let [x, y] = caster.median_position();
    let (mut wrong, mut high, mut buildings, mut total) = (0, 0, 0, 0);
    for v in 1..=VIEWS {
        // From street level to 400 m up, looking down more or less.
        let at = DVec2::new(x, y) + 300.0 * (DVec2::new(halton(v, 2), halton(v, 3)) - 0.5);
        let Some(ground) = caster.ground(at.x, at.y) else {
            continue;
        };
        let up = 25.0 * 16.0_f64.powf(halton(v, 5));
        let turn = std::f64::consts::TAU * halton(v, 7);
        let target = at + up * 1.5 * DVec2::new(turn.cos(), turn.sin());
        let eye = at.extend(ground + up);
        let pose = Pose::looking_at(eye, target.extend(ground));
        let camera = Camera::pinhole(pose, 0.9);
        let sun = Sun::from_azimuth_altitude(200.0, 40.0);
        renderer.prepare(&support::request(&camera, &sun, SIZE)).unwrap();
        let projection = camera.projection(SIZE);
        for k in 1..=PIXELS {
            let pixel = DVec2::new(halton(v * PIXELS + k, 2), halton(v * PIXELS + k, 3));
            let direction = projection.direction_at(pixel * DVec2::new(1280.0, 720.0));
            let truth = caster.cast(eye.to_array(), direction.to_array());
            let (id, t) = match truth {
                Truth::Sky => continue,
                Truth::Ground { t } => (0, t),
                Truth::Building { t, id } => (id, t),
            };
            total += 1;
            buildings += u32::from(id != 0);
            let found = pick(&renderer.resident.tiles, eye, direction);
            match found {
                Some(hit) if hit.fid == id => {
                    let elevation = |t: f64| (eye + t * direction).z;
                    high += u32::from((elevation(f64::from(hit.t)) - elevation(t)).abs() > 0.1);
                }
                _ => wrong += 1,
            }
        }
    }
    println!(
        "{name}: {total} pixels, {buildings} on buildings: {wrong} wrong ids, {high} heights off by more than 0.1 m"
    );
    assert!(
        total > 1000 && buildings > 200,
        "{name}: {total} pixels, {buildings} on buildings"
    );
    assert!(
        1000 * (wrong + high) <= total,
        "{name}: {wrong} wrong, {high} off, of {total}"
    );
}

#[test]
fn picks_in_the_sample_city_are_true() {
    let files = support::sample().join("files");
    let caster = Raycaster::open(
        &files.join("terrain.tif"),
        &files.join("buildings.gpkg"),
        "height_m",
    );
    picks_are_true("sample", &support::sample().join("city"), &caster);
}

fn imported(terrain: &Path, footprints: &Path, folder: &Path) -> (PathBuf, Raycaster) {
    let out = folder.join("city");
    let text = |path: &Path| path.display().to_string();
    support::succeed(&[
        "import",
        "--terrain",
        &text(terrain),
        "--buildings",
        &text(footprints),
        "--height-field",
        "height_m",
        "--out",
        &text(&out),
    ]);
    (out, Raycaster::open(terrain, footprints, "height_m"))
}

#[test]
fn picks_in_a_made_up_region_are_true() {
    let folder = tempfile::tempdir().unwrap();
    let files = folder.path().join("files");
    support::succeed(&[
        "sample",
        "--buildings",
        "3000",
        "--km2",
        "8",
        &files.display().to_string(),
    ]);
    let (city, caster) = imported(
        &files.join("terrain.tif"),
        &files.join("buildings.gpkg"),
        folder.path(),
    );
    picks_are_true("region", &city, &caster);
}

#[test]
fn picks_in_a_real_town_are_true() {
    let Some(data) = support::shared_data() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let (city, caster) = imported(
        &data.join("mamre_za/derived_dtm25_utm34s_clip.tif"),
        &data.join("mamre_za/derived_buildings_epsg32734.gpkg"),
        folder.path(),
    );
    picks_are_true("mamre", &city, &caster);
}
