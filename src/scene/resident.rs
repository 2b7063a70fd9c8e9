//! A city's tiles on the GPU.

use super::SceneError;
use super::ground::{GroundSlot, TerrainMesh, load_ground};
use super::imagery::load_imagery;
use super::maps::{TileSlot, load_maps};
use crate::city::City;
use crate::gpu::{Gpu, GpuError, TextureArray, storage_buffer};
use crate::space::{TileGrid, TileId};

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
    /// Imagery pixels along a tile's side as resident.
    pub imagery_side: u32,
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
    /// Per grid tile: building slot and orthophoto layer.
    pub tile_table: wgpu::TextureView,
    /// `slots` on the GPU.
    pub slot_buffer: wgpu::Buffer,
    /// Cell words.
    pub cells: TextureArray,
    /// Bounds on the roofs, a node of 4 x 4 children a texel.
    pub pyramid: TextureArray,
    /// Roofs and outlines' corners of all tiles.
    pub corners: wgpu::Buffer,
    /// Piece lists of all tiles.
    pub lists: wgpu::Buffer,
    /// Metres along its outline, for every corner.
    pub along_outline: wgpu::Buffer,
    /// Ground records.
    pub ground_buffer: wgpu::Buffer,
    /// Heights.
    pub heights: TextureArray,
    /// Triangles of the ground, as sample indices.
    pub ground_indices: wgpu::Buffer,
    /// Orthophotos.
    pub imagery: TextureArray,
}

impl Resident {
    /// Loads every tile.
    pub fn load(gpu: &Gpu, city: &City, mesh: TerrainMesh) -> Result<Self, SceneError> {
        city.require_all_tiles()?;
        let manifest = city.manifest();
        let tiles: Vec<TileId> = manifest.grid.tiles().collect();
        let mut table = vec![[-1_i32; 2]; tiles.len()];
        let ground = load_ground(gpu, city, &tiles, mesh)?;
        let maps = load_maps(gpu, city, &tiles, &ground, &mut table)?;
        let (imagery, imagery_side, imagery_bytes) = load_imagery(gpu, city, &tiles, &mut table)?;
        let slot_buffer = storage_buffer(gpu, "tile slots", &maps.slots)?;
        let bytes = ground.bytes + maps.bytes + imagery_bytes;
        Ok(Self {
            grid: manifest.grid,
            texel_m: manifest.texel_m,
            tile_texels: manifest.tile_texels as u32,
            terrain_step_m: manifest.terrain_step_m,
            terrain_side: manifest.terrain_side as u32,
            imagery_side,
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
            corners: maps.corners,
            lists: maps.lists,
            along_outline: maps.along_outline,
            ground_buffer: ground.records,
            heights: ground.heights,
            ground_indices: ground.indices,
            imagery,
        })
    }
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
