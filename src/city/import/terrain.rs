//! Terrain tiles: sampled, filled, tessellated.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use super::ImportOptions;
use super::plan::Plan;
use super::sources::Sources;
use crate::city::ground_cache::GroundCache;
use crate::city::writer::TileWriter;
use crate::city::{CityError, Layer, TerrainTile, Tile};
use crate::source::DtmSampler;
use crate::space::TileId;
use crate::terrain::{Apron, HeightTile, fill_gaps, grid_triangles, meshes};

/// Counts over all tiles.
pub struct TerrainTotals {
    /// Tiles with ground.
    pub tiles: u64,
    /// Triangles of the TIN.
    pub triangles: u64,
    /// Triangles of the regular grid.
    pub grid_triangles: u64,
    /// Samples filled in narrow holes.
    pub filled: u64,
}

/// Makes every terrain tile that is not there yet.
pub fn make_terrain(
    sources: &Sources,
    options: &ImportOptions,
    plan: &Plan,
    writer: &TileWriter<'_>,
    ground: &GroundCache,
) -> Result<TerrainTotals, CityError> {
    let tiles: Vec<TileId> = plan.grid.tiles().collect();
    let bar = options.progress.begin("terrain");
    bar.set_length(tiles.len() as u64);
    let totals = [const { AtomicU64::new(0) }; 4];
    let (dtm, crs) = (&sources.dtm, &sources.crs);
    tiles
        .par_iter()
        .with_min_len(4)
        .map_init(
            || dtm.sampler(crs),
            |sampler, &id| -> Result<(), CityError> {
                // A tile that an interrupted import left unreadable is made again.
                let known = writer.terrain(id);
                let terrain = if known.is_some() {
                    known
                } else {
                    let sampler = match sampler {
                        Ok(sampler) => sampler,
                        Err(_) => &mut dtm.sampler(crs)?,
                    };
                    let (tile, filled) = terrain_tile(sampler, plan, id, options.terrain_error_m)?;
                    totals[3].fetch_add(filled, Ordering::Relaxed);
                    tile
                };
                if let Some(terrain) = &terrain {
                    totals[0].fetch_add(1, Ordering::Relaxed);
                    totals[1].fetch_add(terrain.meshes[0].len() as u64, Ordering::Relaxed);
                    totals[2].fetch_add(grid_triangles(&terrain.ground).len() as u64, Ordering::Relaxed);
                }
                let tile = Tile::new(id, terrain, None, None);
                writer.put(&tile, &[Layer::Terrain])?;
                ground.keep(id, tile.terrain.map(|terrain| Arc::new(terrain.ground)));
                bar.inc(1);
                Ok(())
            },
        )
        .collect::<Result<(), _>>()?;
    bar.finish_and_clear();
    let [tiles, triangles, grid_triangles, filled] = totals.map(AtomicU64::into_inner);
    Ok(TerrainTotals {
        tiles,
        triangles,
        grid_triangles,
        filled,
    })
}

/// Samples, fills and tessellates one tile; none where there is no ground. Beside it the samples filled.
fn terrain_tile(
    sampler: &mut DtmSampler,
    plan: &Plan,
    id: TileId,
    tolerance_m: f64,
) -> Result<(Option<TerrainTile>, u64), CityError> {
    let side = plan.terrain_side;
    let intervals = side as i64 - 1;
    let corner = DVec2::new(plan.grid.west, plan.grid.south);
    let first = [i64::from(id.x) * intervals, i64::from(id.y) * intervals];
    let lattice = |sampler: &mut DtmSampler, margin: usize| {
        let first = first.map(|index| index - margin as i64);
        sampler.lattice(corner, plan.terrain_step_m, first, [side + 2 * margin; 2])
    };
    let mut apron = lattice(sampler, 1)?;
    let missing = |heights: &[f32]| heights.iter().filter(|height| !height.is_finite()).count() as u64;
    let mut filled = 0;
    if missing(&apron) > 0 && plan.fill_samples > 0 {
        let margin = plan.fill_samples + 2;
        let wide_side = side + 2 * margin;
        let mut wide = lattice(sampler, margin)?;
        fill_gaps(&mut wide, [wide_side; 2], plan.fill_samples);
        let before = missing(&apron);
        apron = cut(&wide, wide_side, margin - 1, side + 2);
        filled = before - missing(&apron);
    }
    if let Some(rounding) = plan.rounding_m {
        apron
            .iter_mut()
            .for_each(|height| *height = (*height / rounding).round() * rounding);
    }
    let ground = HeightTile {
        side,
        level: 0,
        step_m: plan.terrain_step_m,
        heights: cut(&apron, side + 2, 1, side),
    };
    if ground.range().is_none() {
        return Ok((None, filled));
    }
    // Ground that not one whole cell has is none.
    if grid_triangles(&ground).is_empty() {
        return Ok((None, filled));
    }
    let meshes = meshes(&ground, &Apron(&apron), tolerance_m);
    Ok((Some(TerrainTile { ground, meshes }), filled))
}

/// The square of `side` samples that starts `margin` in from the corner.
fn cut(heights: &[f32], wide: usize, margin: usize, side: usize) -> Vec<f32> {
    (0..side)
        .flat_map(|row| {
            let start = (row + margin) * wide + margin;
            heights[start..start + side].iter().copied()
        })
        .collect()
}
