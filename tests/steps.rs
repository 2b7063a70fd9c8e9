//! Heights stored in whole metres: noticed, smoothed within half a step, alike on both sides of every tile border.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::path::PathBuf;

use rilievo::city::City;
use support::survey::{Raster, import};
use tempfile::TempDir;

const CORNER: [f64; 2] = [300_000.0, 4_800_000.0];

const SIZE: usize = 1400;

/// Rolling hills with a lake in the middle.
fn hills(column: usize, row: usize) -> f64 {
    let (x, y) = (column as f64, row as f64);
    let ground = 100.0 + 14.0 * (x / 210.0).sin() * (y / 170.0).cos() + 0.02 * x + 3.0 * (y / 60.0).sin();
    let shore = 0.15 * ((x - 700.0).hypot(y - 700.0) - 120.0);
    let depth = shore.clamp(-1.0, 1.0).mul_add(0.5, 0.5);
    ground * depth + 95.0 * (1.0 - depth)
}

/// Hills of 1 m pixels in whole metres, imported.
fn imported(more: &[&str]) -> (TempDir, PathBuf, String) {
    let folder = tempfile::tempdir().unwrap();
    let raster = Raster {
        epsg: 32633,
        corner: CORNER,
        pixel: [1.0; 2],
        size: [SIZE; 2],
    };
    let path = folder.path().join("dtm.tif");
    raster.write(
        &path,
        |column, row| hills(column, row).round() as i16,
        Some(-32768.0),
    );
    let site = [CORNER[0] + 300.0, CORNER[1] - 300.0];
    let (out, said) = import(
        folder.path(),
        &[&path],
        &[site],
        &[&["--margin", "20000"], more].concat(),
    );
    (folder, out, said)
}

/// Every sample: column, row, height.
fn samples(city: &City) -> Vec<(usize, usize, f32)> {
    let manifest = city.manifest();
    let mut samples = Vec::new();
    for id in manifest.grid.tiles() {
        let Some(tile) = city.terrain(id).unwrap() else {
            continue;
        };
        let origin = manifest.grid.origin(id);
        for (k, &height) in tile.ground.heights.iter().enumerate() {
            if height.is_finite() {
                let x = origin.x + (k % tile.ground.side) as f64 - CORNER[0];
                let y = CORNER[1] - origin.y - (k / tile.ground.side) as f64;
                samples.push((x as usize, y as usize, height));
            }
        }
    }
    samples
}

#[test]
fn whole_metres_are_said_and_smoothed_within_half_a_step() {
    let (_folder, out, said) = imported(&[]);
    assert!(
        said.contains("whole steps of 1 m") && said.contains("--keep-steps"),
        "{said}"
    );
    let city = City::open(&out).unwrap();
    let (mut sum, mut stored_sum, mut count) = (0.0, 0.0, 0.0);
    for (column, row, height) in samples(&city) {
        let stored = hills(column, row).round();
        let height = f64::from(height);
        assert!(
            (height - stored).abs() <= 0.5001,
            "{column} {row}: {height} of {stored}"
        );
        if (column as f64 - 700.0).hypot(row as f64 - 700.0) < 90.0 {
            assert_eq!(height, 95.0, "the lake at {column} {row}");
        }
        sum += (height - hills(column, row)).powi(2);
        stored_sum += (stored - hills(column, row)).powi(2);
        count += 1.0;
    }
    let (rms, stored_rms) = (f64::sqrt(sum / count), f64::sqrt(stored_sum / count));
    println!("off the hills by {rms:.3} m rms, as stored {stored_rms:.3} m");
    assert!(rms < 0.5 * stored_rms, "{rms} of {stored_rms}");
    // The terraces made a triangle of nearly every sample at their edges.
    println!("{} triangles", city.manifest().terrain_triangles);
    assert!(city.manifest().terrain_triangles < 60_000);
}

#[test]
fn tiles_agree_on_every_smoothed_border() {
    let (_folder, out, _) = imported(&[]);
    let city = City::open(&out).unwrap();
    let mut seen = std::collections::HashMap::new();
    let mut shared = 0;
    for (column, row, height) in samples(&city) {
        if let Some(other) = seen.insert((column, row), height.to_bits()) {
            assert_eq!(other, height.to_bits(), "{column} {row}");
            shared += 1;
        }
    }
    assert!(shared > 4000, "{shared}");
}

#[test]
fn keep_steps_keeps_them() {
    let (_folder, out, said) = imported(&["--keep-steps"]);
    assert!(said.contains("kept as they are"), "{said}");
    let city = City::open(&out).unwrap();
    println!("{} triangles", city.manifest().terrain_triangles);
    for (column, row, height) in samples(&city) {
        assert_eq!(f64::from(height), hills(column, row).round(), "{column} {row}");
    }
}
