//! Loads a city's tiles and puts them on the GPU.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use thiserror::Error;

use super::photo_mips::photo_mips;
use crate::buildings::{BuildingMap, OutlineVertex, Pyramid, RoofRecord};
use crate::city::{City, CityError};
use crate::gpu::{Gpu, GpuError, TextureArray, storage_buffer};
use crate::space::{TileGrid, TileId};
use crate::terrain::grid_triangles;

/// A city could not be made resident.
#[derive(Debug, Error)]
pub enum SceneError {
    /// A tile could not be read.
    #[error(transparent)]
    City(#[from] CityError),
    /// The device refused it.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Which triangles carry the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerrainMesh {
    /// The irregular network, within the city's stated error.
    Tin,
    /// Every lattice cell.
    Grid,
}

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

/// A ground tile's record; layout of `GroundTile` in `shaders/terrain/ground.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GroundTile {
    /// Column and row.
    pub tile: [i32; 2],
    /// Layer of the height texture.
    pub layer: u32,
    /// Keeps the record at 16 bytes.
    pub padding: u32,
}

/// A ground tile to draw.
#[derive(Clone, Debug)]
pub struct GroundSlot {
    /// Which tile.
    pub tile: TileId,
    /// Its part of the index buffer.
    pub indices: std::ops::Range<u32>,
    /// Lowest and highest ground, metres.
    pub range: [f32; 2],
}

/// A city on the GPU.
pub struct Resident {
    /// The tile grid.
    pub grid: TileGrid,
    /// Side of a texel, metres.
    pub texel_m: f64,
    /// Texels along a tile's side.
    pub tile_texels: u32,
    /// Distance between terrain samples, metres.
    pub terrain_step_m: f64,
    /// Terrain samples along a tile's side.
    pub terrain_side: u32,
    /// Photo pixels along a tile's side as resident.
    pub photo_side: u32,
    /// Highest roof of the city, metres.
    pub highest_roof: f32,
    /// Lowest ground of the tiles with buildings, metres.
    pub lowest_ground: f32,
    /// Tiles with buildings, in slot order.
    pub building_tiles: Vec<TileId>,
    /// Their records.
    pub slots: Vec<TileSlot>,
    /// Tiles with ground, in the order of their records.
    pub ground: Vec<GroundSlot>,
    /// Bytes resident on the GPU.
    pub bytes: u64,
    /// Per grid tile: building slot and photo layer.
    pub tile_table: wgpu::TextureView,
    /// `slots` on the GPU.
    pub slot_buffer: wgpu::Buffer,
    /// Cell words.
    pub cells: TextureArray,
    /// Highest roofs of the quarters of each block.
    pub pyramid: TextureArray,
    /// Outline vertices of all tiles.
    pub vertices: wgpu::Buffer,
    /// Piece lists of all tiles.
    pub pieces: wgpu::Buffer,
    /// Roofs of all tiles.
    pub roofs: wgpu::Buffer,
    /// Ground records.
    pub ground_buffer: wgpu::Buffer,
    /// Heights.
    pub heights: TextureArray,
    /// Triangles of the ground, as sample indices.
    pub ground_indices: wgpu::Buffer,
    /// Photos.
    pub photos: TextureArray,
}

/// Tiles read in parallel at a time: bounds the memory beside the GPU's.
const BATCH: usize = 32;

/// Most bytes of photos kept; larger cities drop the finest mip levels.
const PHOTO_BYTES: u64 = 1 << 30;

impl Resident {
    /// Loads every tile.
    pub fn load(gpu: &Gpu, city: &City, mesh: TerrainMesh) -> Result<Self, SceneError> {
        city.require_all_tiles()?;
        let manifest = city.manifest();
        let tiles: Vec<TileId> = manifest.grid.tiles().collect();
        let mut table = vec![[-1_i32; 2]; tiles.len()];
        let ground = load_ground(gpu, city, &tiles, mesh)?;
        let maps = load_maps(gpu, city, &tiles, &ground, &mut table)?;
        let (photos, photo_side, photo_bytes) = load_photos(gpu, city, &tiles, &mut table)?;
        let slot_buffer = storage_buffer(gpu, "tile slots", &maps.slots)?;
        let bytes = ground.bytes + maps.bytes + photo_bytes;
        Ok(Self {
            grid: manifest.grid,
            texel_m: manifest.texel_m,
            tile_texels: manifest.tile_texels as u32,
            terrain_step_m: manifest.terrain_step_m,
            terrain_side: manifest.terrain_side as u32,
            photo_side,
            highest_roof: maps
                .slots
                .iter()
                .map(|slot| slot.high)
                .fold(f32::NEG_INFINITY, f32::max),
            lowest_ground: maps
                .slots
                .iter()
                .map(|slot| slot.low)
                .fold(f32::INFINITY, f32::min),
            building_tiles: maps.tiles,
            slots: maps.slots,
            ground: ground.slots,
            bytes,
            tile_table: table_texture(gpu, &manifest.grid, &table)?,
            slot_buffer,
            cells: maps.cells,
            pyramid: maps.pyramid,
            vertices: maps.vertices,
            pieces: maps.pieces,
            roofs: maps.roofs,
            ground_buffer: ground.records,
            heights: ground.heights,
            ground_indices: ground.indices,
            photos,
        })
    }
}

struct GroundData {
    slots: Vec<GroundSlot>,
    records: wgpu::Buffer,
    heights: TextureArray,
    indices: wgpu::Buffer,
    bytes: u64,
}

fn load_ground(
    gpu: &Gpu,
    city: &City,
    tiles: &[TileId],
    mesh: TerrainMesh,
) -> Result<GroundData, SceneError> {
    let side = city.manifest().terrain_side as u32;
    let present: Vec<TileId> = tiles
        .iter()
        .copied()
        .filter(|&tile| city.has_terrain(tile))
        .collect();
    let heights = TextureArray::new(
        gpu,
        "terrain heights",
        wgpu::TextureFormat::R32Float,
        side,
        1,
        present.len() as u32,
    )?;
    let (mut slots, mut records, mut indices) = (Vec::new(), Vec::new(), Vec::<u32>::new());
    for batch in present.chunks(BATCH) {
        let loaded: Vec<_> = batch
            .par_iter()
            .map(|&tile| city.terrain(tile).map(|terrain| (tile, terrain)))
            .collect::<Result<_, _>>()?;
        for (tile, terrain) in loaded {
            let Some(terrain) = terrain else { continue };
            let Some(range) = terrain.ground.range() else {
                continue;
            };
            let layer = slots.len() as u32;
            // A texture holds no missing samples: they lie under no triangle, so any height will do.
            let filled: Vec<f32> = terrain
                .ground
                .heights
                .iter()
                .map(|&height| if height.is_finite() { height } else { range[0] })
                .collect();
            heights.write(gpu, layer, 0, &filled);
            let first = indices.len() as u32;
            match mesh {
                TerrainMesh::Tin => indices.extend(terrain.triangles.iter().flatten()),
                TerrainMesh::Grid => indices.extend(grid_triangles(&terrain.ground).iter().flatten()),
            }
            records.push(GroundTile {
                tile: [tile.x as i32, tile.y as i32],
                layer,
                padding: 0,
            });
            slots.push(GroundSlot {
                tile,
                indices: first..indices.len() as u32,
                range,
            });
        }
        flush(gpu)?;
    }
    gpu.require(
        "the terrain mesh",
        4 * indices.len() as u64,
        gpu.device.limits().max_buffer_size,
    )?;
    let index_buffer = index_buffer(gpu, &indices);
    Ok(GroundData {
        bytes: u64::from(side * side * 4) * slots.len() as u64 + 4 * indices.len() as u64,
        records: storage_buffer(gpu, "ground tiles", &records)?,
        slots,
        heights,
        indices: index_buffer,
    })
}

fn index_buffer(gpu: &Gpu, indices: &[u32]) -> wgpu::Buffer {
    use wgpu::util::{BufferInitDescriptor, DeviceExt};
    gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some("ground indices"),
        contents: if indices.is_empty() {
            &[0; 4]
        } else {
            bytemuck::cast_slice(indices)
        },
        usage: wgpu::BufferUsages::INDEX,
    })
}

struct MapData {
    tiles: Vec<TileId>,
    slots: Vec<TileSlot>,
    cells: TextureArray,
    pyramid: TextureArray,
    vertices: wgpu::Buffer,
    pieces: wgpu::Buffer,
    roofs: wgpu::Buffer,
    bytes: u64,
}

fn load_maps(
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

fn load_photos(
    gpu: &Gpu,
    city: &City,
    tiles: &[TileId],
    table: &mut [[i32; 2]],
) -> Result<(TextureArray, u32, u64), SceneError> {
    let full_side = city.manifest().photo_side as u32;
    let present: Vec<TileId> = tiles
        .iter()
        .copied()
        .filter(|&tile| city.has_photo(tile))
        .collect();
    let bytes_at = |side: u32| u64::from(side) * u64::from(side) * 16 / 3 * present.len() as u64;
    let mut dropped = 0;
    while bytes_at(full_side >> dropped) > PHOTO_BYTES {
        dropped += 1;
    }
    let side = (full_side >> dropped).max(1);
    let levels = side.ilog2() + 1;
    let array = TextureArray::new(
        gpu,
        "photos",
        wgpu::TextureFormat::Rgba8UnormSrgb,
        side,
        levels,
        present.len() as u32,
    )?;
    let mut layer = 0;
    for batch in present.chunks(BATCH) {
        let loaded: Vec<_> = batch
            .par_iter()
            .map(|&tile| {
                let photo = city.photo(tile)?;
                Ok(photo.map(|photo| (tile, photo_mips(photo.rgba, photo.side))))
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

/// Hands queued uploads to the device so that their staging memory is freed.
fn flush(gpu: &Gpu) -> Result<(), GpuError> {
    gpu.queue.submit([]);
    gpu.wait()
}

fn table_texture(gpu: &Gpu, grid: &TileGrid, table: &[[i32; 2]]) -> Result<wgpu::TextureView, GpuError> {
    use wgpu::util::{DeviceExt, TextureDataOrder};
    let most = u64::from(gpu.device.limits().max_texture_dimension_2d);
    gpu.require("the tile grid", u64::from(grid.columns.max(grid.rows)), most)?;
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some("tile table"),
            size: wgpu::Extent3d {
                width: grid.columns,
                height: grid.rows,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rg32Sint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(table),
    );
    Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
}
