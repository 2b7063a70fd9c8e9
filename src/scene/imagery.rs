//! Imagery tiles on the GPU.

use rayon::prelude::*;

use super::SceneError;
use super::batch::{BATCH, flush};
use super::imagery_mips::imagery_mips;
use crate::city::{City, CityError};
use crate::gpu::{Gpu, TextureArray};
use crate::space::TileId;

/// Most bytes of orthophotos kept; larger cities drop the finest mip levels.
const IMAGERY_BYTES: u64 = 1 << 30;

/// Loads the orthophotos of every tile that has one, and enters their layer in the table; also their side as resident, and bytes.
pub fn load_imagery(
    gpu: &Gpu,
    city: &City,
    tiles: &[TileId],
    table: &mut [[i32; 2]],
) -> Result<(TextureArray, u32, u64), SceneError> {
    let full_side = city.manifest().imagery_side as u32;
    let present: Vec<TileId> = tiles
        .iter()
        .copied()
        .filter(|&tile| city.has_imagery(tile))
        .collect();
    let bytes_at = |side: u32| u64::from(side) * u64::from(side) * 16 / 3 * present.len() as u64;
    let mut dropped = 0;
    while bytes_at(full_side >> dropped) > IMAGERY_BYTES {
        dropped += 1;
    }
    let side = (full_side >> dropped).max(1);
    let levels = side.ilog2() + 1;
    let array = TextureArray::new(
        gpu,
        "photos",
        wgpu::TextureFormat::Rgba8UnormSrgb,
        [side; 2],
        levels,
        present.len() as u32,
    )?;
    let mut layer = 0;
    for batch in present.chunks(BATCH) {
        let loaded: Vec<_> = batch
            .par_iter()
            .map(|&tile| {
                let imagery = city.imagery(tile)?;
                Ok(imagery.map(|imagery| (tile, imagery_mips(imagery.rgba, imagery.side))))
            })
            .collect::<Result<_, CityError>>()?;
        for (tile, mips) in loaded.into_iter().flatten() {
            for (level, texels) in (0..).zip(&mips[dropped as usize..]) {
                array.write(gpu, layer, level, texels);
            }
            let row = city.manifest().grid.columns as usize * tile.y as usize;
            table[row + tile.x as usize][1] = layer as i32;
            layer += 1;
        }
        flush(gpu)?;
    }
    Ok((array, side, bytes_at(side)))
}
