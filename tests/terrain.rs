//! The TIN keeps its promise on every sample of the sample city, costs far less than the grid, and leaves
//! no crack at any tile border.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::collections::BTreeSet;

use rilievo::city::{City, TerrainTile};
use rilievo::space::TileId;
use rilievo::terrain::{Apron, HeightTile, grid_triangles, tin_triangles};

fn tiles() -> (City, Vec<(TileId, TerrainTile)>) {
    let city = City::open(&support::sample().join("city")).unwrap();
    let grid = city.manifest().grid;
    let tiles = grid
        .tiles()
        .filter_map(|id| Some((id, city.terrain(id).unwrap()?)))
        .collect();
    (city, tiles)
}

/// Vertical distance of every known sample from the tin, by walking each triangle's samples; samples under no
/// triangle count as missed.
fn errors(tile: &HeightTile, triangles: &[[u32; 3]]) -> (f64, usize) {
    let side = tile.side;
    let mut error = vec![f64::NAN; side * side];
    for triangle in triangles {
        let corner = triangle.map(|k| [f64::from(k % side as u32), f64::from(k / side as u32)]);
        let height = triangle.map(|k| f64::from(tile.heights[k as usize]));
        let area = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        let whole = area(corner[0], corner[1], corner[2]);
        assert!(whole > 0.0, "a triangle is not counter-clockwise");
        let range = |axis: usize| {
            let values = corner.map(|c| c[axis]);
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            low as usize..=values.iter().copied().fold(0.0, f64::max) as usize
        };
        for j in range(1) {
            for i in range(0) {
                let p = [i as f64, j as f64];
                let weights = [
                    area(p, corner[1], corner[2]) / whole,
                    area(corner[0], p, corner[2]) / whole,
                    area(corner[0], corner[1], p) / whole,
                ];
                if weights.iter().all(|weight| *weight >= -1e-12) {
                    let on_mesh: f64 = weights
                        .iter()
                        .zip(height)
                        .map(|(weight, height)| weight * height)
                        .sum();
                    error[j * side + i] = (on_mesh - f64::from(tile.heights[j * side + i])).abs();
                }
            }
        }
    }
    let known = |k: &usize| tile.heights[*k].is_finite();
    let missed = (0..side * side)
        .filter(known)
        .filter(|&k| error[k].is_nan())
        .count();
    (
        error
            .iter()
            .copied()
            .filter(|error| !error.is_nan())
            .fold(0.0, f64::max),
        missed,
    )
}

#[test]
fn every_sample_is_within_the_stated_error() {
    let (city, tiles) = tiles();
    let (mut tin, mut grid) = (0, 0);
    for (id, tile) in &tiles {
        let (worst, missed) = errors(&tile.ground, &tile.meshes[0]);
        assert!(
            worst <= city.manifest().terrain_error_m + 1e-4,
            "{id:?}: {worst} m"
        );
        // Beside missing ground a sample may carry no cell at all.
        let whole = tile.ground.heights.iter().all(|height| height.is_finite());
        assert!(
            !whole || missed == 0,
            "{id:?}: {missed} samples under no triangle"
        );
        tin += tile.meshes[0].len();
        grid += grid_triangles(&tile.ground).len();
    }
    println!("triangles: tin {tin}, grid {grid}");
    assert_eq!(tin as u64, city.manifest().terrain_triangles);
    assert!(tin * 20 < grid, "the tin has {tin} triangles, the grid {grid}");
}

/// Points (sample index along the border, height) of a tile's triangles on one border.
fn border(tile: &TerrainTile, on: impl Fn(usize, usize) -> Option<usize>) -> BTreeSet<(usize, u32)> {
    let side = tile.ground.side;
    tile.meshes[0]
        .iter()
        .flatten()
        .filter_map(|&k| {
            let along = on(k as usize % side, k as usize / side)?;
            Some((along, tile.ground.heights[k as usize].to_bits()))
        })
        .collect()
}

#[test]
fn neighbours_share_every_vertex_of_their_border() {
    let (_, tiles) = tiles();
    let find = |x: u32, y: u32| {
        tiles
            .iter()
            .find(|(id, _)| (id.x, id.y) == (x, y))
            .map(|(_, tile)| tile)
    };
    let mut borders = 0;
    for (id, tile) in &tiles {
        let last = tile.ground.side - 1;
        if let Some(east) = find(id.x + 1, id.y) {
            let mine = border(tile, |i, j| (i == last).then_some(j));
            assert_eq!(mine, border(east, |i, j| (i == 0).then_some(j)), "east of {id:?}");
            borders += 1;
        }
        if let Some(north) = find(id.x, id.y + 1) {
            let mine = border(tile, |i, j| (j == last).then_some(i));
            assert_eq!(
                mine,
                border(north, |i, j| (j == 0).then_some(i)),
                "north of {id:?}"
            );
            borders += 1;
        }
    }
    assert!(borders > 20, "only {borders} borders were walked");
}

/// A rough surface with a hole, at four turns: the bound must not depend on orientation.
#[test]
fn the_bound_holds_on_rough_ground_with_a_hole_at_four_turns() {
    let side = 65_usize;
    for turn in 0..4 {
        let height = |i: i64, j: i64| {
            let (mut u, mut v) = (i as f64 - 32.0, j as f64 - 32.0);
            for _ in 0..turn {
                (u, v) = (-v, u);
            }
            if (u - 6.0).hypot(v + 3.0) < 7.0 {
                return f32::NAN;
            }
            (12.0 * (u / 7.0).sin() + 5.0 * (v / 3.0).cos() + if u > 10.0 { 9.0 } else { 0.0 }) as f32
        };
        let square = |side: usize, start: i64| -> Vec<f32> {
            (0..side * side)
                .map(|k| height((k % side) as i64 + start, (k / side) as i64 + start))
                .collect()
        };
        let tile = HeightTile {
            side,
            level: 0,
            step_m: 1.0,
            heights: square(side, 0),
        };
        let apron = square(side + 2, -1);
        let triangles = tin_triangles(&tile, &Apron(&apron), 0.25);
        let (worst, _) = errors(&tile, &triangles);
        assert!(worst <= 0.2501, "turn {turn}: {worst}");
        // Exactly the cells with four known corners are covered.
        let area: f64 = triangles
            .iter()
            .map(|triangle| {
                let c = triangle.map(|k| (f64::from(k % side as u32), f64::from(k / side as u32)));
                0.5 * ((c[1].0 - c[0].0) * (c[2].1 - c[0].1) - (c[1].1 - c[0].1) * (c[2].0 - c[0].0))
            })
            .sum();
        let cells = grid_triangles(&tile).len() as f64 / 2.0;
        assert!(
            (area - cells).abs() < 1e-6,
            "turn {turn}: {area} of {cells} cells"
        );
    }
}
