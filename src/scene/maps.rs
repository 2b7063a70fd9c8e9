//! Building-map tiles on the GPU.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::SceneError;
use super::batch::{BATCH, flush};
use super::ground::GroundData;
use crate::buildings::{BuildingMap, OutlineVertex, Pyramid, RoofRecord};
use crate::city::{City, CityError};
use crate::gpu::{Gpu, TextureArray, storage_buffer};
use crate::space::TileId;

/// Where a tile's building map lies in the shared buffers; layout of `TileSlot` in `shaders/lib/building_map.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct TileSlot {
    /// Column and row.
    pub tile: [i32; 2],
    /// First outline vertex.
    pub vertex_base: u32,
    /// First piece.
    pub piece_base: u32,
    /// First roof.
    pub roof_base: u32,
    /// Keeps the record at 32 bytes.
    pub padding: u32,
    /// Lowest ground, metres.
    pub low: f32,
    /// Highest roof, metres.
    pub high: f32,
}

/// The building map of all tiles on the GPU.
pub struct MapData {
    pub tiles: Vec<TileId>,
    pub slots: Vec<TileSlot>,
    pub cells: TextureArray,
    pub pyramid: TextureArray,
    pub vertices: wgpu::Buffer,
    pub pieces: wgpu::Buffer,
    pub roofs: wgpu::Buffer,
    pub bytes: u64,
}

/// Loads the building map of every tile that has one, and enters its slot in the table.
pub fn load_maps(
    gpu: &Gpu,
    city: &City,
    tiles: &[TileId],
    ground: &GroundData,
    table: &mut [[i32; 2]],
) -> Result<MapData, SceneError> {
    let side = city.manifest().tile_texels as u32;
    let levels = side.ilog2();
    let present: Vec<TileId> = tiles
        .iter()
        .copied()
        .filter(|&tile| city.has_buildings(tile))
        .collect();
    let layers = present.len() as u32;
    let cells = TextureArray::new(
        gpu,
        "building map cells",
        wgpu::TextureFormat::R32Uint,
        side,
        1,
        layers,
    )?;
    let pyramid = TextureArray::new(
        gpu,
        "building map pyramid",
        wgpu::TextureFormat::Rgba16Float,
        side / 2,
        levels,
        layers,
    )?;
    let (mut resident, mut slots) = (Vec::new(), Vec::new());
    let mut vertices: Vec<OutlineVertex> = Vec::new();
    let mut pieces: Vec<u32> = Vec::new();
    let mut roofs: Vec<RoofRecord> = Vec::new();
    let lowest_ground: std::collections::HashMap<TileId, f32> = ground
        .slots
        .iter()
        .map(|slot| (slot.tile, slot.range[0]))
        .collect();
    for batch in present.chunks(BATCH) {
        let loaded: Vec<Option<(TileId, BuildingMap, Pyramid)>> = batch
            .par_iter()
            .map(|&tile| {
                Ok(city.buildings(tile)?.map(|map| {
                    let pyramid = Pyramid::of(&map);
                    (tile, map, pyramid)
                }))
            })
            .collect::<Result<_, CityError>>()?;
        for (tile, map, maxima) in loaded.into_iter().flatten() {
            let slot = slots.len() as u32;
            cells.write(gpu, slot, 0, &map.cells);
            let lowest_base = map
                .roofs
                .iter()
                .map(|roof| roof.base_m)
                .fold(f32::INFINITY, f32::min);
            let low = lowest_ground
                .get(&tile)
                .copied()
                .unwrap_or(lowest_base)
                .min(lowest_base);
            for level in 1..=levels {
                pyramid.write(gpu, slot, level - 1, &maxima.quarters(level as usize, low));
            }
            slots.push(TileSlot {
                tile: [tile.x as i32, tile.y as i32],
                vertex_base: vertices.len() as u32,
                piece_base: pieces.len() as u32,
                roof_base: roofs.len() as u32,
                padding: 0,
                low,
                high: maxima.top(),
            });
            let row = city.manifest().grid.columns as usize * tile.y as usize;
            table[row + tile.x as usize][0] = slot as i32;
            resident.push(tile);
            vertices.extend(&map.vertices);
            pieces.extend(&map.pieces);
            roofs.extend(&map.roofs);
        }
        flush(gpu)?;
    }
    let texels = u64::from(side) * u64::from(side) * slots.len() as u64;
    Ok(MapData {
        bytes: texels * 4
            + texels * 8 / 3
            + 16 * vertices.len() as u64
            + 4 * pieces.len() as u64
            + 16 * roofs.len() as u64,
        tiles: resident,
        slots,
        cells,
        pyramid,
        vertices: storage_buffer(gpu, "building outlines", &vertices)?,
        pieces: storage_buffer(gpu, "building pieces", &pieces)?,
        roofs: storage_buffer(gpu, "building roofs", &roofs)?,
    })
}
