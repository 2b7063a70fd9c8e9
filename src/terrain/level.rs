//! The quadtree's levels: ground with every second sample, and which meshes carry it.

use super::{Apron, HeightTile, tin_triangles};

/// Errors of a tile's meshes, the finest first, in multiples of the city's stated error. The tiles of level 0 are looked at from near
/// and far and have several; coarse ones are seen from afar only.
pub fn mesh_errors(level: u32) -> Vec<f64> {
    match level {
        0 => vec![1.0, 4.0, 16.0],
        _ => vec![8.0 * f64::from(1_u32 << level)],
    }
}

/// The meshes of a tile, for a city's stated error in metres. A mesh without a triangle has one without area.
pub fn meshes(tile: &HeightTile, apron: &Apron<'_>, error_m: f64) -> Vec<Vec<[u32; 3]>> {
    let mesh = |factor: f64| match tin_triangles(tile, apron, (factor * error_m) as f32) {
        triangles if triangles.is_empty() => vec![[0; 3]],
        triangles => triangles,
    };
    mesh_errors(tile.level).into_iter().map(mesh).collect()
}

/// Ground over four tiles of the level below (south-west, south-east, north-west, north-east), with every second of their samples, and
/// how far it departs from theirs at most, metres; none without any.
pub fn coarser_ground(children: [Option<&HeightTile>; 4]) -> Option<(HeightTile, f32)> {
    let first = children.iter().flatten().next()?;
    let (side, cells) = (first.side, first.side - 1);
    let sample = |i: usize, j: usize| {
        // A sample on the border between children is in two or four of them.
        let candidates = [i / cells, i.saturating_sub(1) / cells];
        let rows = [j / cells, j.saturating_sub(1) / cells];
        for row in rows.map(|row| row.min(1)) {
            for column in candidates.map(|column| column.min(1)) {
                if let Some(child) = children[column + 2 * row] {
                    let height = child.heights[(j - row * cells) * side + i - column * cells];
                    if height.is_finite() {
                        return height;
                    }
                }
            }
        }
        f32::NAN
    };
    let tile = HeightTile {
        side,
        level: first.level + 1,
        step_m: 2.0 * first.step_m,
        heights: (0..side * side)
            .map(|k| sample(2 * (k % side), 2 * (k / side)))
            .collect(),
    };
    let mut error = 0.0_f32;
    let fine = tile.refined(2);
    for j in 0..fine.side {
        for i in 0..fine.side {
            let off = (fine.heights[j * fine.side + i] - sample(i, j)).abs();
            error = if off.is_finite() { error.max(off) } else { error };
        }
    }
    Some((tile, error))
}

/// Meshes of a tile whose neighbours are not at hand: missing samples are known by its own alone.
pub fn meshes_alone(tile: &HeightTile, error_m: f64) -> Vec<Vec<[u32; 3]>> {
    let wide = tile.side + 2;
    let clamped = |index: usize| index.clamp(1, tile.side) - 1;
    let apron: Vec<f32> = (0..wide * wide)
        .map(|k| tile.heights[clamped(k / wide) * tile.side + clamped(k % wide)])
        .collect();
    meshes(tile, &Apron(&apron), error_m)
}
