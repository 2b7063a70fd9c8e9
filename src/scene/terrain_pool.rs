//! Terrain on the device: heights, their maxima, and the meshes that carry them.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

use super::SceneError;
use super::skirt::skirts;
use crate::city::TerrainTile;
use crate::gpu::{Gpu, IndexPool, IndexRun, LayerPool, RecordPool};
use crate::space::TileId;
use crate::terrain::{GroundBounds, grid_triangles};

/// Which triangles carry the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerrainMesh {
    /// TINs, within the city's stated error or what a pixel hides.
    Tin,
    /// Every lattice cell.
    Grid,
}

/// A terrain tile's record; layout of `GroundRecord` in `shaders/lib/terrain.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GroundRecord {
    /// Column and row of the south-western tile of the grid that it covers.
    pub tile: [i32; 2],
    /// Its level.
    pub level: u32,
    /// Layer of the height texture.
    pub layer: u32,
}

/// The indices of one mesh.
#[derive(Clone, Debug)]
pub struct MeshIndices {
    /// Its triangles.
    pub surface: Range<u32>,
    /// Skirts that hang from its border in the south, east, north and west.
    pub skirts: [Range<u32>; 4],
}

/// A terrain tile to draw.
#[derive(Clone)]
pub struct TerrainSlot {
    /// Which tile.
    pub tile: TileId,
    /// Its meshes, the finest first.
    pub meshes: Vec<MeshIndices>,
    /// Lowest and highest ground, metres.
    pub range: [f32; 2],
    run: IndexRun,
    record: u32,
}

/// The terrain of all resident tiles. A slot is a layer and a record.
pub struct TerrainPool {
    mesh: TerrainMesh,
    /// Records, by slot.
    pub records: RecordPool<GroundRecord>,
    /// Heights, a layer a slot.
    pub heights: LayerPool,
    /// Maxima of blocks, a layer a slot.
    pub bounds: LayerPool,
    /// Triangles, as indices of mesh positions.
    pub indices: IndexPool,
    slots: Vec<Option<TerrainSlot>>,
}

impl TerrainPool {
    /// An empty pool of tiles of `side` samples along a side.
    ///
    /// # Errors
    /// When the device cannot hold one.
    pub fn new(gpu: &Gpu, mesh: TerrainMesh, side: u32) -> Result<Self, SceneError> {
        let format = wgpu::TextureFormat::R32Float;
        let blocks = GroundBounds::BLOCKS as u32;
        Ok(Self {
            mesh,
            records: RecordPool::new(gpu, "terrain slots"),
            heights: LayerPool::new(gpu, "terrain heights", format, [side; 2], 1)?,
            bounds: LayerPool::new(gpu, "terrain bounds", format, [blocks; 2], GroundBounds::LEVELS)?,
            indices: IndexPool::new(gpu, "terrain triangles"),
            slots: Vec::new(),
        })
    }

    /// Makes room for tiles as many times as those given; true when what shaders read was made anew.
    ///
    /// # Errors
    /// When the device allows no more.
    pub fn reserve(&mut self, gpu: &Gpu, tiles: &[&TerrainTile], times: f64) -> Result<bool, SceneError> {
        // A tenth for skirts.
        let triangles = tiles.iter().flat_map(|tile| &tile.meshes).map(Vec::len);
        let indices = triangles.sum::<usize>() as f64 * 3.3 * times;
        self.indices.reserve(gpu, indices as u64);
        let count = (tiles.len() as f64 * times) as u32;
        let heights = self.heights.reserve(gpu, count)?;
        Ok(self.bounds.reserve(gpu, count)? || heights)
    }

    /// The same a part at a time, while frames go on.
    ///
    /// # Errors
    /// When the device allows no more.
    pub fn grow_a_part(&mut self, gpu: &Gpu, count: u32) -> Result<bool, SceneError> {
        let heights = self.heights.grow_a_part(gpu, count)?;
        Ok(self.bounds.grow_a_part(gpu, count)? || heights)
    }

    /// Tiles that may come.
    pub fn room(&self, gpu: &Gpu) -> u32 {
        self.heights.room(gpu).min(self.bounds.room(gpu))
    }

    /// Puts a tile that has ground; its slot, and true when what shaders read was made anew.
    ///
    /// # Errors
    /// When the device holds no more.
    pub fn put(
        &mut self,
        gpu: &Gpu,
        tile: TileId,
        terrain: &TerrainTile,
        bounds: &GroundBounds,
    ) -> Result<(u32, bool), SceneError> {
        let range = terrain.ground.range().unwrap_or_default();
        let (layer, grows) = self.heights.take(gpu)?;
        let (bounds_layer, grows_bounds) = self.bounds.take(gpu)?;
        // A texture holds no missing samples: they lie under no triangle, so any height will do.
        let known = |&height: &f32| if height.is_finite() { height } else { range[0] };
        let filled: Vec<f32> = terrain.ground.heights.iter().map(known).collect();
        self.heights.write(gpu, layer, 0, &filled);
        for level in 0..GroundBounds::LEVELS {
            self.bounds.write(gpu, bounds_layer, level, bounds.level(level));
        }
        let (indices, meshes) = self.mesh_indices(terrain);
        let run = self.indices.put(gpu, &indices)?;
        let first = [tile.x, tile.y].map(|index| (index << tile.level) as i32);
        let record = GroundRecord {
            tile: first,
            level: tile.level,
            layer,
        };
        let (slot, grows_records) = self.records.put(gpu, record)?;
        if self.slots.len() <= layer as usize {
            self.slots.resize(layer as usize + 1, None);
        }
        let place = |range: &Range<u32>| run.part(range);
        self.slots[layer as usize] = Some(TerrainSlot {
            tile,
            meshes: meshes
                .iter()
                .map(|mesh| MeshIndices {
                    surface: place(&mesh.surface),
                    skirts: mesh.skirts.each_ref().map(place),
                })
                .collect(),
            range,
            run,
            record: slot,
        });
        Ok((layer, grows || grows_bounds || grows_records))
    }

    /// The indices of all meshes of a tile, and where each of them lies.
    fn mesh_indices(&self, terrain: &TerrainTile) -> (Vec<u32>, Vec<MeshIndices>) {
        let grid;
        let meshes = match self.mesh {
            TerrainMesh::Tin => &terrain.meshes,
            TerrainMesh::Grid => {
                grid = vec![grid_triangles(&terrain.ground)];
                &grid
            }
        };
        let mut indices = Vec::new();
        let mut parts = Vec::new();
        for triangles in meshes {
            let mut append = |triangles: &[[u32; 3]]| {
                let first = indices.len() as u32;
                indices.extend(triangles.iter().flatten());
                first..indices.len() as u32
            };
            let surface = append(triangles);
            let skirts = skirts(triangles, terrain.ground.mesh_side());
            let skirts = skirts.each_ref().map(|skirt| append(skirt));
            parts.push(MeshIndices { surface, skirts });
        }
        (indices, parts)
    }

    /// A tile by its slot.
    pub fn slot(&self, slot: u32) -> Option<&TerrainSlot> {
        self.slots.get(slot as usize)?.as_ref()
    }

    /// The number of a tile's record.
    pub fn record_of(&self, slot: u32) -> Option<u32> {
        self.slot(slot).map(|slot| slot.record)
    }

    /// Drops a tile.
    pub fn drop(&mut self, slot: u32) {
        if let Some(tile) = self.slots.get_mut(slot as usize).and_then(Option::take) {
            self.indices.free(tile.run);
            self.records.free(tile.record);
            self.heights.free(slot);
            self.bounds.free(slot);
        }
    }

    /// Bytes of a tile's heights and maxima.
    pub fn tile_bytes(&self) -> u64 {
        self.heights.image_bytes() + self.bounds.image_bytes()
    }

    /// Bytes of the tiles in it.
    pub fn bytes_used(&self) -> u64 {
        u64::from(self.heights.count()) * self.tile_bytes() + self.indices.bytes()
    }
}
