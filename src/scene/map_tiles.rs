//! Building-map tiles on the GPU.

use bytemuck::{Pod, Zeroable};

use super::SceneError;
use crate::buildings::{BuildingMap, MapTile, Pyramid};
use crate::gpu::{Gpu, TextureArray, storage_buffer};

/// Where a tile's building map lies in the shared buffers; layout of `TileRecord` in `shaders/lib/building_map.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct TileRecord {
    /// First outline vertex.
    pub vertex_base: u32,
    /// First list.
    pub list_base: u32,
    /// Lowest ground, metres.
    pub min_height: f32,
    /// Highest roof, metres.
    pub max_height: f32,
}

/// A vertex of an outline, or a roof; layout of `OutlineVertex` in `shaders/lib/building_map.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct VertexRecord {
    /// Metres from the tile's south-west corner.
    pub position: [f32; 2],
    /// Elevation of the building's roof, metres.
    pub roof_m: f32,
    /// Id of the building.
    pub fid: u32,
}

/// Building maps on their way to the GPU.
pub struct MapUpload {
    slots: Vec<TileRecord>,
    cells: TextureArray,
    pyramid: TextureArray,
    vertices: Vec<VertexRecord>,
    lists: Vec<u32>,
    along_outline: Vec<f32>,
    bytes: u64,
}

/// The building maps of all resident tiles on the GPU.
pub struct MapTiles {
    /// Records of the tiles.
    pub slots: wgpu::Buffer,
    /// Cell codes.
    pub cells: TextureArray,
    /// Bounds on the roofs, a node of 4 x 4 children a texel.
    pub pyramid: TextureArray,
    /// Roofs and outline vertices of all tiles.
    pub vertices: wgpu::Buffer,
    /// Lists of cell codes of all tiles.
    pub lists: wgpu::Buffer,
    /// Metres along its outline, for every vertex.
    pub along_outline: wgpu::Buffer,
    /// Bytes on the GPU.
    pub bytes: u64,
}

impl MapUpload {
    /// Room for `layers` tiles of `side` texels along a side.
    pub fn new(gpu: &Gpu, side: u32, layers: u32) -> Result<Self, SceneError> {
        let cell_format = wgpu::TextureFormat::R32Uint;
        let node_format = wgpu::TextureFormat::Rgba32Uint;
        let nodes = Pyramid::image_size(side as usize).map(|count| count as u32);
        Ok(Self {
            slots: Vec::new(),
            cells: TextureArray::new(gpu, "building map cells", cell_format, [side; 2], [1, layers])?,
            pyramid: TextureArray::new(gpu, "building map pyramid", node_format, nodes, [1, layers])?,
            vertices: Vec::new(),
            lists: Vec::new(),
            along_outline: Vec::new(),
            bytes: 0,
        })
    }

    /// Uploads one tile; its slot.
    pub fn put(&mut self, gpu: &Gpu, MapTile { map, pyramid }: &MapTile) -> u32 {
        let slot = self.slots.len() as u32;
        self.bytes += (map.bytes() + Pyramid::bytes(map.side)) as u64;
        self.cells.write(gpu, slot, 0, &map.cells);
        self.pyramid.write(gpu, slot, 0, pyramid.nodes());
        self.slots.push(TileRecord {
            vertex_base: (self.vertices.len() + map.roofs.len()) as u32,
            list_base: self.lists.len() as u32,
            min_height: pyramid.min_height(),
            max_height: pyramid.max_height(),
        });
        self.vertices.extend(vertex_records(map));
        self.lists.extend(&map.lists);
        self.along_outline.extend(map.roofs.iter().map(|_| 0.0));
        self.along_outline
            .extend(map.vertices.iter().map(|vertex| vertex.along_m));
        slot
    }

    /// Uploads what all tiles share.
    pub fn finish(self, gpu: &Gpu) -> Result<MapTiles, SceneError> {
        Ok(MapTiles {
            slots: storage_buffer(gpu, "tile slots", &self.slots)?,
            cells: self.cells,
            pyramid: self.pyramid,
            vertices: storage_buffer(gpu, "building outlines", &self.vertices)?,
            lists: storage_buffer(gpu, "building lists", &self.lists)?,
            along_outline: storage_buffer(gpu, "lengths along outlines", &self.along_outline)?,
            bytes: self.bytes,
        })
    }
}

/// A map's roofs, the last first, and its outline vertices.
fn vertex_records(map: &BuildingMap) -> impl Iterator<Item = VertexRecord> {
    let roofs = map.roofs.iter().rev().map(|roof| VertexRecord {
        position: [0.0; 2],
        roof_m: roof.roof_m,
        fid: roof.fid,
    });
    roofs.chain(map.vertices.iter().map(|vertex| {
        let roof = &map.roofs[vertex.building as usize];
        VertexRecord {
            position: [vertex.x_m, vertex.y_m],
            roof_m: roof.roof_m,
            fid: roof.fid,
        }
    }))
}
