//! Building-map tiles on the GPU.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::SceneError;
use super::batch::{BATCH, flush};
use super::ground::GroundData;
use crate::buildings::{BuildingMap, Pyramid};
use crate::city::{City, CityError};
use crate::gpu::{Gpu, TextureArray, storage_buffer};
use crate::space::TileId;

/// Where a tile's building map lies in the shared buffers; layout of `TileSlot` in `shaders/lib/building_map.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct TileSlot {
    /// First outline corner.
    pub corner_base: u32,
    /// First list.
    pub list_base: u32,
    /// Lowest ground, metres.
    pub low: f32,
    /// Highest roof, metres.
    pub high: f32,
}

/// A corner of an outline, or a roof; layout of `Corner` in `shaders/lib/building_map.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Corner {
    /// Metres from the tile's south-west corner.
    pub position: [f32; 2],
    /// Elevation of the building's roof, metres.
    pub roof_m: f32,
    /// Id of the building.
    pub fid: u32,
}

/// The building map of all tiles on the GPU.
pub struct MapData {
    pub tiles: Vec<TileId>,
    pub slots: Vec<TileSlot>,
    pub cells: TextureArray,
    pub pyramid: TextureArray,
    pub corners: wgpu::Buffer,
    pub lists: wgpu::Buffer,
    pub along_outline: wgpu::Buffer,
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
        [side; 2],
        1,
        layers,
    )?;
    let pyramid = TextureArray::new(
        gpu,
        "building map pyramid",
        wgpu::TextureFormat::Rgba32Uint,
        Pyramid::image_size(side as usize).map(|count| count as u32),
        1,
        layers,
    )?;
    let (mut resident, mut slots) = (Vec::new(), Vec::new());
    let mut corners: Vec<Corner> = Vec::new();
    let mut lists: Vec<u32> = Vec::new();
    let mut along_outline: Vec<f32> = Vec::new();
    let mut bytes = 0;
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
                    let low = lowest_ground
                        .get(&tile)
                        .copied()
                        .unwrap_or(f32::INFINITY)
                        .min(map.lowest_base());
                    let pyramid = Pyramid::from_map(&map, low);
                    (tile, map, pyramid)
                }))
            })
            .collect::<Result<_, CityError>>()?;
        for (tile, map, maxima) in loaded.into_iter().flatten() {
            let slot = slots.len() as u32;
            bytes += (map.bytes() + Pyramid::bytes(map.side)) as u64;
            cells.write(gpu, slot, 0, &map.cells);
            pyramid.write(gpu, slot, 0, maxima.nodes());
            slots.push(TileSlot {
                corner_base: (corners.len() + map.roofs.len()) as u32,
                list_base: lists.len() as u32,
                low: maxima.low(),
                high: maxima.top(),
            });
            let row = city.manifest().grid.columns as usize * tile.y as usize;
            table[row + tile.x as usize][0] = slot as i32;
            resident.push(tile);
            corners.extend(corners_of(&map));
            lists.extend(&map.lists);
            along_outline.extend(map.roofs.iter().map(|_| 0.0));
            along_outline.extend(map.vertices.iter().map(|vertex| vertex.along_m));
        }
        flush(gpu)?;
    }
    Ok(MapData {
        bytes,
        tiles: resident,
        slots,
        cells,
        pyramid,
        corners: storage_buffer(gpu, "building outlines", &corners)?,
        lists: storage_buffer(gpu, "building lists", &lists)?,
        along_outline: storage_buffer(gpu, "lengths along outlines", &along_outline)?,
    })
}

/// A map's roofs, the last first, and its outlines' corners.
fn corners_of(map: &BuildingMap) -> impl Iterator<Item = Corner> {
    let roofs = map.roofs.iter().rev().map(|roof| Corner {
        position: [0.0; 2],
        roof_m: roof.roof_m,
        fid: roof.fid,
    });
    roofs.chain(map.vertices.iter().map(|vertex| {
        let roof = &map.roofs[vertex.building as usize];
        Corner {
            position: [vertex.x_m, vertex.y_m],
            roof_m: roof.roof_m,
            fid: roof.fid,
        }
    }))
}
