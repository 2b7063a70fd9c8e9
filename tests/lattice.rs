//! Ground where it is measured: the lattice of made surveys against the survey's own samples.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::path::Path;

use glam::{DVec2, DVec3};
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::Renderer;
use rilievo::scene::TerrainMesh;
use rilievo::space::Sun;
use support::View;
use support::raycaster::{Raycaster, Truth};
use support::survey::{Raster, import};

/// West and north edge of the made surveys, EPSG:32633.
const CORNER: [f64; 2] = [300_000.0, 4_800_000.0];

fn raster(pixel_m: f64, size: usize) -> Raster {
    Raster {
        epsg: 32633,
        corner: CORNER,
        pixel: [pixel_m; 2],
        size: [size; 2],
    }
}

/// A number in -1..1 from two whole ones.
fn hash(i: i64, j: i64) -> f64 {
    let mut x =
        (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (j as u64).wrapping_mul(0x2545_f491_4f6c_dd1d);
    x = (x ^ (x >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^= x >> 29;
    (x % 20_001) as f64 / 10_000.0 - 1.0
}

/// A steep town: slopes up to 45 degrees, ridges, and every sample off by up to a twelfth of the spacing.
fn steep(x: f64, y: f64, spacing: f64) -> f32 {
    let waves = 90.0 * (x / 240.0).sin() * (y / 310.0).cos() + 30.0 * ((x + 0.7 * y) / 90.0).sin();
    let ridge = 40.0 * (1.0 - (((x - 0.4 * y) / 260.0).fract() - 0.5).abs() * 2.0);
    (400.0 + waves + ridge + spacing / 12.0 * hash(x as i64, y as i64)) as f32
}

fn city(folder: &Path) -> City {
    City::open(folder).unwrap()
}

/// Every sample of the city as (column, row from the north, height) of a raster of its own spacing.
fn samples(city: &City, raster: &Raster) -> Vec<(i64, i64, f32)> {
    let manifest = city.manifest();
    let mut samples = Vec::new();
    for id in manifest.grid.tiles() {
        let Some(tile) = city.terrain(id).unwrap() else {
            continue;
        };
        let origin = manifest.grid.origin(id);
        for (k, &height) in tile.ground.heights.iter().enumerate() {
            let (i, j) = (k % tile.ground.side, k / tile.ground.side);
            let column =
                (origin.x + i as f64 * manifest.terrain_step_m - raster.corner[0]) / raster.pixel[0] - 0.5;
            let row =
                (raster.corner[1] - origin.y - j as f64 * manifest.terrain_step_m) / raster.pixel[1] - 0.5;
            assert!((column - column.round()).abs() < 1e-3 && (row - row.round()).abs() < 1e-3);
            samples.push((column.round() as i64, row.round() as i64, height));
        }
    }
    samples
}

/// The city's samples are the raster's, to the last bit.
fn assert_copied(city: &City, raster: &Raster, height: impl Fn(usize, usize) -> f32) {
    let mut copied = 0;
    for (column, row, found) in samples(city, raster) {
        let inside = [column, row]
            .iter()
            .zip(raster.size)
            .all(|(index, count)| (0..count as i64).contains(index));
        if inside {
            assert_eq!(
                found.to_bits(),
                height(column as usize, row as usize).to_bits(),
                "{column} {row}"
            );
            copied += 1;
        } else {
            assert!(found.is_nan());
        }
    }
    assert!(copied > raster.size[0] * raster.size[1] / 2, "{copied}");
}

#[test]
fn samples_are_copied_to_the_last_bit() {
    // Spacing, tile and samples a side; the last is 10 m written with a rounding error.
    for (pixel_m, tile_m, side) in [
        (10.0, 510.0, 52),
        (30.0, 510.0, 18),
        (90.0, 540.0, 7),
        (2.0, 512.0, 257),
        (10.000_000_001, 510.0, 52),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let raster = raster(pixel_m, 120);
        let path = folder.path().join("dtm.tif");
        let height =
            |column: usize, row: usize| steep(column as f64 * pixel_m, row as f64 * pixel_m, pixel_m) / 3.0;
        raster.write(&path, height, None);
        let site = [CORNER[0] + 60.0 * pixel_m, CORNER[1] - 60.0 * pixel_m];
        let (out, _) = import(folder.path(), &[&path], &[site], &["--margin", "20000"]);
        let city = city(&out);
        assert_eq!(city.manifest().grid.tile_m, tile_m);
        assert_eq!(city.manifest().terrain_side, side);
        assert_copied(&city, &raster, height);
    }
}

#[test]
fn a_mosaic_of_whole_metres_in_several_files_is_copied() {
    let folder = tempfile::tempdir().unwrap();
    let whole = raster(25.0, 100);
    let height = |column: usize, row: usize| steep(column as f64 * 25.0, row as f64 * 25.0, 25.0).round();
    let parts: Vec<_> = [(0, 0), (1, 0), (0, 1), (1, 1)]
        .into_iter()
        .map(|(x, y)| {
            let part = Raster {
                corner: [CORNER[0] + 1250.0 * x as f64, CORNER[1] - 1250.0 * y as f64],
                size: [50; 2],
                ..whole
            };
            let path = folder.path().join(format!("dtm_{x}_{y}.tif"));
            part.write(
                &path,
                |column, row| height(column + 50 * x, row + 50 * y) as i16,
                Some(-32768.0),
            );
            path
        })
        .collect();
    let paths: Vec<&Path> = parts.iter().map(|path| path.as_path()).collect();
    let site = [CORNER[0] + 1200.0, CORNER[1] - 1300.0];
    let (out, said) = import(folder.path(), &paths, &[site], &["--margin", "20000"]);
    assert!(!said.contains("whole steps"), "{said}");
    assert_copied(&city(&out), &whole, height);
}

#[test]
fn rectangular_pixels_lie_on_the_lattice_too() {
    let folder = tempfile::tempdir().unwrap();
    let raster = Raster {
        pixel: [10.0, 20.0],
        size: [150, 75],
        ..raster(10.0, 0)
    };
    let path = folder.path().join("dtm.tif");
    let height = |column: usize, row: usize| steep(10.0 * column as f64, 20.0 * row as f64, 10.0);
    raster.write(&path, height, None);
    let site = [CORNER[0] + 700.0, CORNER[1] - 700.0];
    let (out, _) = import(folder.path(), &[&path], &[site], &["--margin", "20000"]);
    let city = city(&out);
    assert_eq!(city.manifest().terrain_step_m, 10.0);
    let mut copied = 0;
    for id in city.manifest().grid.tiles() {
        let Some(tile) = city.terrain(id).unwrap() else {
            continue;
        };
        let origin = city.manifest().grid.origin(id);
        for (k, &found) in tile.ground.heights.iter().enumerate() {
            let x = origin.x + 10.0 * (k % tile.ground.side) as f64;
            let y = origin.y + 10.0 * (k / tile.ground.side) as f64;
            let row = (CORNER[1] - y) / 20.0 - 0.5;
            let column = (x - CORNER[0]) / 10.0 - 0.5;
            if row.fract() == 0.0 && (0.0..75.0).contains(&row) && (0.0..150.0).contains(&column) {
                assert_eq!(found, height(column as usize, row as usize));
                copied += 1;
            }
        }
    }
    assert!(copied > 8000, "{copied}");
}

/// The picture of a steep survey is its bilinear surface: 99.5 % of the ground within 0.30 m, from street to sky.
fn assert_true_ground(terrain: &Path, out: &Path, centre: [f64; 2], extent: f64) {
    let caster = Raycaster::open(terrain, &out.with_file_name("footprints.geojson"), "height");
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city(out), TerrainMesh::Tin).unwrap();
    let ground = |x: f64, y: f64| caster.ground(x, y).unwrap();
    let [x, y] = centre;
    for (name, eye, target) in [
        (
            "street",
            [x, y, ground(x, y) + 1.7],
            [x + 40.0, y + 25.0, ground(x + 40.0, y + 25.0) + 1.7],
        ),
        (
            "oblique",
            [x - 0.5 * extent, y - 0.4 * extent, ground(x, y) + 0.3 * extent],
            [x, y, ground(x, y)],
        ),
        (
            "high",
            [x - 0.3 * extent, y - 0.3 * extent, ground(x, y) + extent],
            [x, y, ground(x, y)],
        ),
    ] {
        let view = View {
            eye: DVec3::from_array(eye),
            target: DVec3::from_array(target),
            fov_y: 60_f64.to_radians(),
        };
        let size = [192, 108];
        let (camera, sun) = (view.camera(), Sun::from_direction(DVec3::Z));
        let still = renderer.still(&support::request(&camera, &sun, size), 1).unwrap();
        let (mut grounds, mut right) = (0, 0);
        for k in 0..size[0] * size[1] {
            let ray = support::ray(&view, size, k % size[0], k / size[0]);
            if !matches!(caster.cast(eye, ray.to_array()), Truth::Ground { .. }) {
                continue;
            }
            let at = view.eye + ray * f64::from(still.depth[k as usize]);
            grounds += 1;
            let error = caster.ground(at.x, at.y).map(|ground| (at.z - ground).abs());
            right += u32::from(still.ids[k as usize] == 0 && error.is_some_and(|error| error <= 0.30));
        }
        let fraction = f64::from(right) / f64::from(grounds);
        println!("{name}: {fraction:.5} of {grounds}");
        assert!(grounds > 3000, "{name}: only {grounds} pixels show ground");
        assert!(fraction >= 0.995, "{name}: {fraction}");
    }
}

#[test]
fn the_picture_of_steep_coarse_surveys_is_true() {
    for pixel_m in [10.0, 30.0, 90.0] {
        println!("{pixel_m} m");
        let folder = tempfile::tempdir().unwrap();
        let raster = raster(pixel_m, (2400.0 / pixel_m) as usize);
        let path = folder.path().join("dtm.tif");
        let height =
            |column: usize, row: usize| steep(column as f64 * pixel_m, row as f64 * pixel_m, pixel_m);
        raster.write(&path, height, None);
        let centre = [CORNER[0] + 1211.0, CORNER[1] - 1207.0];
        let site = [centre[0] - 30.0, centre[1] - 60.0];
        let (out, _) = import(folder.path(), &[&path], &[site], &["--margin", "20000"]);
        assert_true_ground(&path, &out, centre, 1400.0);
    }
}

/// Pixels of one arc second, from a corner on the globe.
const SECONDS: Raster = Raster {
    epsg: 4326,
    corner: [12.5, 43.3],
    pixel: [1.0 / 3600.0; 2],
    size: [160; 2],
};

/// Imports a raster in degrees into UTM; the city and the fraction of its ground within 0.30 m of the raster's surface.
fn in_degrees(folder: &Path, height: impl Fn(usize, usize) -> f32) -> (City, f64) {
    let path = folder.join("dtm.tif");
    SECONDS.write(&path, &height, None);
    let reference = |epsg: u32| {
        let mut reference = gdal::spatial_ref::SpatialRef::from_epsg(epsg).unwrap();
        reference.set_axis_mapping_strategy(gdal::spatial_ref::AxisMappingStrategy::TraditionalGisOrder);
        reference
    };
    let transform = |from: u32, to: u32| {
        gdal::spatial_ref::CoordTransform::new(&reference(from), &reference(to)).unwrap()
    };
    let (mut x, mut y) = ([12.5 + 80.0 / 3600.0], [43.3 - 80.0 / 3600.0]);
    transform(4326, 32633)
        .transform_coords(&mut x, &mut y, &mut [0.0])
        .unwrap();
    let (out, _) = import(folder, &[&path], &[[x[0], y[0]]], &["--margin", "1500"]);
    let city = city(&out);
    let to_degrees = transform(32633, 4326);
    let (mut right, mut count) = (0.0, 0.0);
    for id in city.manifest().grid.tiles() {
        let tile = city.terrain(id).unwrap().unwrap().ground;
        let origin = city.manifest().grid.origin(id);
        for k in 0..1600 {
            let at = [(k % 40) as f64 * 12.7 + 3.1, (k / 40) as f64 * 12.7 + 1.7];
            let (mut x, mut y) = ([origin.x + at[0]], [origin.y + at[1]]);
            to_degrees.transform_coords(&mut x, &mut y, &mut [0.0]).unwrap();
            let (u, v) = ((x[0] - 12.5) * 3600.0 - 0.5, (43.3 - y[0]) * 3600.0 - 0.5);
            let (i, j) = (u as usize, v as usize);
            let (fu, fv) = (u - i as f64, v - j as f64);
            let h = |di: usize, dj: usize| f64::from(height(i + di, j + dj));
            let truth = (h(0, 0) * (1.0 - fu) + h(1, 0) * fu) * (1.0 - fv)
                + (h(0, 1) * (1.0 - fu) + h(1, 1) * fu) * fv;
            count += 1.0;
            right += f64::from(u8::from(
                (tile.ground(at[0], at[1]).unwrap() - truth).abs() <= 0.30,
            ));
        }
    }
    (city, right / count)
}

#[test]
fn a_source_in_degrees_gets_the_coarsest_spacing_that_follows_it() {
    let gentle =
        |column: usize, row: usize| (200.0 + 3.0 * (column as f64 / 25.0).sin() + 0.2 * row as f64) as f32;
    let rough = |column: usize, row: usize| steep(30.0 * column as f64, 30.0 * row as f64, 30.0);
    let folder = tempfile::tempdir().unwrap();
    let (city, fraction) = in_degrees(folder.path(), gentle);
    println!("gentle: {} m, {fraction:.5}", city.manifest().terrain_step_m);
    assert_eq!(city.manifest().grid.tile_m, 512.0);
    assert!(fraction >= 0.995 && city.manifest().terrain_step_m >= 16.0);
    let folder = tempfile::tempdir().unwrap();
    let (city, fraction) = in_degrees(folder.path(), rough);
    println!("steep: {} m, {fraction:.5}", city.manifest().terrain_step_m);
    assert_eq!(city.manifest().grid.tile_m, 512.0);
    assert!(fraction >= 0.995, "{fraction}");
    assert!((2.0..=4.0).contains(&city.manifest().terrain_step_m));
}

#[test]
fn holes_in_a_coarse_survey_are_filled_or_left() {
    for (fill, filled) in [("95", true), ("50", false)] {
        let folder = tempfile::tempdir().unwrap();
        let raster = raster(90.0, 40);
        let path = folder.path().join("dtm.tif");
        let plane = |column: usize, row: usize| 300.0 + 9.0 * column as f32 - 4.0 * row as f32;
        let hole = |column: usize, row: usize| {
            (column, row) == (20, 20) || (10..14).contains(&column) && (30..34).contains(&row)
        };
        raster.write(
            &path,
            |column, row| {
                if hole(column, row) {
                    -32768.0
                } else {
                    plane(column, row)
                }
            },
            Some(-32768.0),
        );
        let site = [CORNER[0] + 1000.0, CORNER[1] - 1000.0];
        let (out, _) = import(
            folder.path(),
            &[&path],
            &[site],
            &["--margin", "20000", "--fill", fill],
        );
        for (column, row, height) in samples(&city(&out), &raster) {
            if (column, row) == (20, 20) {
                assert_eq!(height.is_finite(), filled, "{height}");
                assert!(!filled || (height - plane(20, 20)).abs() < 1e-3);
            }
            assert!((column, row) != (11, 31) || height.is_nan());
        }
    }
}

/// A building that stands over the terrain's edge is whole in the city, on whichever side, and the ground stays where it was.
#[test]
fn a_building_over_the_edge_of_the_terrain_is_not_cut() {
    let raster = raster(2.0, 100);
    let [west, north] = CORNER;
    let [east, south] = [west + 200.0, north - 200.0];
    for corner in [
        [west - 5.0, south + 100.0],
        [east - 3.0, south + 100.0],
        [west + 100.0, south - 5.0],
        [west + 100.0, north - 3.0],
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dtm.tif");
        raster.write(&path, |column, row| (column + 2 * row) as f32, None);
        let (out, said) = import(
            folder.path(),
            &[&path],
            &[corner, [west + 60.0, south + 60.0]],
            &[],
        );
        let city = City::open(&out).unwrap();
        let bounds = city.manifest().grid.bounds();
        let [x, y] = corner;
        assert!(
            bounds.west <= x && bounds.south <= y && bounds.east >= x + 8.0 && bounds.north >= y + 8.0,
            "{corner:?}: {bounds:?} {said}"
        );
        // The middle of a pixel.
        let at = DVec2::new(west + 61.0, south + 81.0);
        let id = city.manifest().grid.tile_at(at).unwrap();
        let ground = city.terrain(id).unwrap().unwrap().ground;
        let local = at - city.manifest().grid.origin(id);
        let height = ground.ground(local.x, local.y).unwrap();
        assert!(
            (height - (30.0 + 2.0 * 59.0)).abs() < 1e-4,
            "{corner:?}: {height}"
        );
    }
}
