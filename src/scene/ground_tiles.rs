//! Ground tiles on the GPU: heights, their maxima, and the triangles that carry them.

use bytemuck::{Pod, Zeroable};

use super::SceneError;
use crate::city::TerrainTile;
use crate::gpu::{Gpu, TextureArray, geometry_buffer, storage_buffer};
use crate::space::TileId;
use crate::terrain::{GroundBounds, grid_triangles};

/// Which triangles carry the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerrainMesh {
    /// The TIN, within the city's stated error.
    Tin,
    /// Every lattice cell.
    Grid,
}

/// A ground tile's record; layout of `GroundTile` in `shaders/lib/terrain.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GroundRecord {
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

/// Ground tiles on their way to the GPU.
pub struct GroundUpload {
    mesh: TerrainMesh,
    slots: Vec<GroundSlot>,
    records: Vec<GroundRecord>,
    indices: Vec<u32>,
    heights: TextureArray,
    bounds: TextureArray,
    side: u32,
}

/// The ground of all resident tiles on the GPU.
pub struct GroundTiles {
    /// Tiles in the order of their records.
    pub slots: Vec<GroundSlot>,
    /// Records.
    pub records: wgpu::Buffer,
    /// Heights, a layer a tile.
    pub heights: TextureArray,
    /// Maxima of blocks, a layer a tile.
    pub bounds: TextureArray,
    /// Triangles, as indices of mesh positions.
    pub indices: wgpu::Buffer,
    /// Bytes on the GPU.
    pub bytes: u64,
}

impl GroundUpload {
    /// Room for `layers` tiles of `side` samples along a side.
    pub fn new(gpu: &Gpu, mesh: TerrainMesh, side: u32, layers: u32) -> Result<Self, SceneError> {
        let format = wgpu::TextureFormat::R32Float;
        let blocks = GroundBounds::BLOCKS as u32;
        let levels = GroundBounds::LEVELS;
        Ok(Self {
            mesh,
            slots: Vec::new(),
            records: Vec::new(),
            indices: Vec::new(),
            heights: TextureArray::new(gpu, "terrain heights", format, [side; 2], [1, layers])?,
            bounds: TextureArray::new(gpu, "terrain bounds", format, [blocks; 2], [levels, layers])?,
            side,
        })
    }

    /// Uploads one tile; its layer, none without a single sample of ground.
    pub fn put(
        &mut self,
        gpu: &Gpu,
        tile: TileId,
        terrain: &TerrainTile,
        bounds: &GroundBounds,
    ) -> Option<u32> {
        let range = terrain.ground.range()?;
        let layer = self.slots.len() as u32;
        // A texture holds no missing samples: they lie under no triangle, so any height will do.
        let known = |&height: &f32| if height.is_finite() { height } else { range[0] };
        let filled: Vec<f32> = terrain.ground.heights.iter().map(known).collect();
        self.heights.write(gpu, layer, 0, &filled);
        for level in 0..GroundBounds::LEVELS {
            self.bounds.write(gpu, layer, level, bounds.level(level));
        }
        let first = self.indices.len() as u32;
        match self.mesh {
            TerrainMesh::Tin => self.indices.extend(terrain.triangles.iter().flatten()),
            TerrainMesh::Grid => self
                .indices
                .extend(grid_triangles(&terrain.ground).iter().flatten()),
        }
        self.records.push(GroundRecord {
            tile: [tile.x as i32, tile.y as i32],
            layer,
            mesh_parts: terrain.ground.mesh_parts() as u32,
        });
        self.slots.push(GroundSlot {
            tile,
            indices: first..self.indices.len() as u32,
            range,
        });
        Some(layer)
    }

    /// Uploads what all tiles share.
    pub fn finish(self, gpu: &Gpu) -> Result<GroundTiles, SceneError> {
        let samples =
            u64::from(self.side * self.side) + (GroundBounds::BLOCKS * GroundBounds::BLOCKS * 4 / 3) as u64;
        Ok(GroundTiles {
            bytes: 4 * (samples * self.slots.len() as u64 + self.indices.len() as u64),
            records: storage_buffer(gpu, "ground tiles", &self.records)?,
            indices: geometry_buffer(gpu, "terrain triangles", &self.indices, wgpu::BufferUsages::INDEX)?,
            slots: self.slots,
            heights: self.heights,
            bounds: self.bounds,
        })
    }
}
