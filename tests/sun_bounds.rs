//! The sun bounds against the rays that they spare: what they call free meets nothing, for ten suns over three cities.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::path::Path;

use glam::{DVec2, DVec3};
use rilievo::camera::Camera;
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::Renderer;
use rilievo::relief::{SunBounds, SunObstacles, cast_buildings, cast_ground, pick};
use rilievo::scene::TerrainMesh;
use rilievo::space::{Pose, Sun};

const SIZE: [u32; 2] = [320, 180];
/// Azimuth and altitude, degrees: on and between the axes, low and high, and one whose disc touches the horizon.
const SUNS: [[f64; 2]; 10] = [
    [180.0, 60.0],
    [225.0, 42.0],
    [90.0, 30.0],
    [135.0, 20.0],
    [315.0, 15.0],
    [271.0, 10.0],
    [12.0, 35.0],
    [45.0, 50.0],
    [299.0, 4.0],
    [63.0, 0.8],
];

/// A point of the sun's disc.
fn towards(sun: &Sun, k: u32) -> DVec3 {
    let side = sun.to_sun.any_orthonormal_vector();
    let across = sun.to_sun.cross(side);
    let radius = sun.angular_radius * (f64::from(k % 16) / 15.0).sqrt();
    let (sin, cos) = (f64::from(k) * 2.399_963).sin_cos();
    (sun.to_sun + radius * (cos * side + sin * across)).normalize()
}

/// Rays from what is seen in a view, for all suns: those that the bounds call free from a distance on meet nothing from there.
fn bounds_hold(name: &str, renderer: &mut Renderer, [eye, target]: [DVec3; 2]) -> [u32; 3] {
    let camera = Camera::pinhole(Pose::looking_at(eye, target), 1.0);
    let (mut rays, mut at_once, mut shorter) = (0, 0, 0);
    for [azimuth, altitude] in SUNS {
        let sun = Sun::from_azimuth_altitude(azimuth, altitude);
        renderer.prepare(&support::request(&camera, &sun, SIZE)).unwrap();
        let tiles = &renderer.resident.tiles;
        // Not where the eye is: the bounds of a view hold for eyes around.
        let centre = eye.truncate() + DVec2::new(37.0, -51.0);
        let Some(bounds) = SunBounds::new(&SunObstacles::of(tiles), &sun, centre, renderer.resident.texel_m)
        else {
            continue;
        };
        let projection = camera.projection(SIZE);
        for k in 0..SIZE[0] * SIZE[1] / 7 {
            let pixel = 7 * k;
            let direction = projection.ray_direction(pixel % SIZE[0], pixel / SIZE[0]);
            let Some(hit) = pick(tiles, eye, direction) else {
                continue;
            };
            // Off the surface by what a shader lifts a ray, towards the eye.
            let start = eye + direction * (f64::from(hit.t) - 0.02);
            let to_sun = towards(&sun, k);
            if to_sun.z <= 0.0 {
                continue;
            }
            rays += 1;
            let t = bounds.clear_from(start, to_sun);
            if !t.is_finite() {
                continue;
            }
            at_once += u32::from(t == 0.0);
            shorter += 1;
            // What is met beyond must have been met before as well: then the ray that is cut short tells the same.
            let meets = |max: f32| {
                cast_buildings(tiles, start, to_sun, max).0.is_some()
                    || cast_ground(tiles, start, to_sun, max).is_some()
            };
            assert!(
                !meets(f32::INFINITY) || meets(t as f32),
                "{name}, sun at {azimuth}, {altitude}: a ray from {start} is called free from {t} m and meets something there"
            );
        }
    }
    println!("{name}: {rays} rays, {at_once} free at once, {shorter} cut short");
    [rays, at_once, shorter]
}

fn open(city: &Path) -> Renderer {
    Renderer::open(Gpu::open().unwrap(), &City::open(city).unwrap(), TerrainMesh::Tin).unwrap()
}

/// Low, oblique and high views over a point.
fn views(at: DVec3) -> [[DVec3; 2]; 3] {
    [
        [-60.0, -80.0, 30.0],
        [-300.0, 260.0, 180.0],
        [500.0, -900.0, 1100.0],
    ]
    .map(|offset| [at + DVec3::from_array(offset), at])
}

fn check(name: &str, renderer: &mut Renderer, at: DVec3) {
    let mut total = [0; 3];
    for view in views(at) {
        let counts = bounds_hold(name, renderer, view);
        total = [0, 1, 2].map(|k| total[k] + counts[k]);
    }
    let [rays, at_once, shorter] = total;
    assert!(rays > 100_000, "{name}: {rays} rays");
    // Bounds that answer little are of no use; many of the suns are low.
    assert!(
        20 * at_once > rays && 2 * shorter > rays,
        "{name}: {at_once} and {shorter} of {rays}"
    );
}

#[test]
fn bounds_of_the_sample_city_hold() {
    let mut renderer = open(&support::sample().join("city"));
    check("sample", &mut renderer, DVec3::new(289_180.0, 4_773_000.0, 215.0));
}

#[test]
fn bounds_of_a_made_up_region_hold() {
    let folder = tempfile::tempdir().unwrap();
    let files = folder.path().join("files");
    let out = folder.path().join("city");
    let text = |path: &Path| path.display().to_string();
    support::succeed(&["sample", "--buildings", "20000", "--km2", "30", &text(&files)]);
    support::succeed(&[
        "import",
        "--terrain",
        &text(&files.join("terrain.tif")),
        "--buildings",
        &text(&files.join("buildings.gpkg")),
        "--height-field",
        "height_m",
        "--out",
        &text(&out),
    ]);
    let mut renderer = open(&out);
    let centre = renderer.resident.tiles.grid.bounds().centre();
    let ground = renderer.resident.ground_at(centre).unwrap();
    check("region", &mut renderer, centre.extend(ground));
}

#[test]
fn bounds_of_a_real_town_hold() {
    let Some(data) = support::shared_data() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("city");
    let text = |path: &Path| path.display().to_string();
    support::succeed(&[
        "import",
        "--terrain",
        &text(&data.join("mamre_za/derived_dtm25_utm34s_clip.tif")),
        "--buildings",
        &text(&data.join("mamre_za/derived_buildings_epsg32734.gpkg")),
        "--height-field",
        "height_m",
        "--out",
        &text(&out),
    ]);
    let mut renderer = open(&out);
    let centre = renderer.resident.tiles.grid.bounds().centre();
    let ground = renderer.resident.ground_at(centre).unwrap();
    check("mamre", &mut renderer, centre.extend(ground));
}
