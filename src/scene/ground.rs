//! Ground tiles on the GPU: heights, and the triangles that carry them.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::SceneError;
use super::batch::{BATCH, flush};
use crate::city::City;
use crate::gpu::{Gpu, TextureArray, storage_buffer};
use crate::space::TileId;
use crate::terrain::grid_triangles;

/// Which triangles carry the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerrainMesh {
    /// The TIN, within the city's stated error.
    Tin,
    /// Every lattice cell.
    Grid,
}

/// A ground tile's record; layout of `GroundTile` in `shaders/terrain/ground.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GroundTile {
    /// Column and row.
    pub tile: [i32; 2],
    /// Layer of the height texture.
    pub layer: u32,
    /// Parts that the mesh divides a cell's side into.
    pub mesh_parts: u32,
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

/// The ground of all tiles on the GPU.
pub struct GroundData {
    pub slots: Vec<GroundSlot>,
    pub records: wgpu::Buffer,
    pub heights: TextureArray,
    pub indices: wgpu::Buffer,
    pub bytes: u64,
}

/// Loads the ground of every tile that has some.
pub fn load_ground(
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
        [side; 2],
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
                mesh_parts: terrain.ground.mesh_parts() as u32,
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
