//! Building maps on the device.

use bytemuck::{Pod, Zeroable};

use super::SceneError;
use crate::buildings::{BuildingMap, CellKind, DeviceMap, MapTile};
use crate::gpu::{Gpu, TexelPool, TexelRun};

/// Words along a row of the pool of words; shaders have it as `POOL_WORDS`.
pub const POOL_WORDS: u32 = 8192;
/// Records of 16 bytes along a row of theirs; shaders have it as `POOL_QUADS`.
pub const POOL_QUADS: u32 = 2048;

/// Where a tile's building map lies in the pool; layout of `TileRecord` in `shaders/lib/building_map.wgsl`, where it is explained.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct TileRecord {
    pub quad_base: u32,
    pub word_base: u32,
    /// Lowest ground, metres.
    pub min_height: f32,
    /// Highest roof, metres.
    pub max_height: f32,
    pub block_base: u32,
    pub roof_quads: u32,
    pub padding_a: u32,
    pub padding_b: u32,
}

/// Records of 16 bytes that a tile's record takes.
const RECORD_QUADS: u32 = (size_of::<TileRecord>() / size_of::<[u32; 4]>()) as u32;

/// A vertex of an outline; layout of `VertexRecord` in `shaders/lib/building_map.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct VertexRecord {
    /// Metres from the tile's south-west corner.
    pub position: [f32; 2],
    /// Elevation of the building's roof, metres: it stands where a roof's record has it.
    pub roof_m: f32,
    /// Index of the building in its tile.
    pub building: u32,
}

/// A roof; layout of `RoofRecord` in `shaders/lib/building_map.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct RoofRecord {
    /// Lowest ground at the building's outline, metres.
    pub base_m: f32,
    /// What the building is made of.
    pub material: u32,
    /// Elevation of the roof, metres.
    pub roof_m: f32,
    /// Id of the building.
    pub fid: u32,
}

/// What stands behind a roof's record; layout of `RoofOutline` in `shaders/lib/building_map.wgsl`, where it is explained.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct RoofOutline {
    pub vertex: u32,
    pub edges: u32,
    pub gaps: u32,
    pub padding: u32,
}

/// Records of 16 bytes that a roof of a map takes: where there are outlines it has a [`RoofOutline`].
fn roof_quads(map: &BuildingMap) -> usize {
    1 + usize::from(map.has_outlines())
}

/// A map that was put.
pub struct MapPut {
    /// Where.
    pub slot: u32,
    /// Bytes on the device.
    pub bytes: u64,
    /// Whether what shaders read was made anew for it.
    pub is_new: bool,
}

/// The building maps of all resident tiles.
pub struct MapPool {
    /// Facade coordinates of outline vertices, and the maps' words.
    pub words: TexelPool,
    /// Of each tile its record, roofs, nodes of the pyramid, outline vertices, blocks.
    pub quads: TexelPool,
    /// By slot.
    runs: Vec<Option<[TexelRun; 2]>>,
    free: Vec<u32>,
}

impl MapPool {
    /// An empty pool.
    ///
    /// # Errors
    /// When the device cannot hold one.
    pub fn new(gpu: &Gpu) -> Result<Self, SceneError> {
        use wgpu::TextureFormat::{R32Uint, Rgba32Uint};
        Ok(Self {
            words: TexelPool::new(gpu, "building map words", R32Uint, POOL_WORDS)?,
            quads: TexelPool::new(gpu, "building map records", Rgba32Uint, POOL_QUADS)?,
            runs: Vec::new(),
            free: Vec::new(),
        })
    }

    /// Makes room for maps as many times as those given; true when what shaders read was made anew.
    pub fn reserve(&mut self, gpu: &Gpu, maps: &[&MapTile], times: f64) -> bool {
        let sizes = maps
            .iter()
            .map(|tile| [tile.map.words.len() + tile.map.vertices.len(), quad_count(tile)]);
        let [words, quads] = sizes.fold([0, 0], |[a, b], [words, quads]| [a + words, b + quads]);
        let [words, quads] = [words, quads].map(|count| (count as f64 * times) as u64);
        let words = self.words.reserve(gpu, words);
        self.quads.reserve(gpu, quads) || words
    }

    /// Makes room for bytes of maps, split as maps mostly are; true when what shaders read was made anew.
    pub fn reserve_bytes(&mut self, gpu: &Gpu, bytes: u64) -> bool {
        /// Parts of a map's bytes.
        const WORDS: f64 = 0.3;
        let words = (bytes as f64 * WORDS) as u64 / size_of::<u32>() as u64;
        let quads = (bytes as f64 * (1.0 - WORDS)) as u64 / size_of::<[u32; 4]>() as u64;
        let words = self.words.reserve(gpu, words);
        self.quads.reserve(gpu, quads) || words
    }

    /// Puts a map; its slot, its bytes, and true when what shaders read was made anew.
    ///
    /// # Errors
    /// When the device holds no more.
    pub fn put(&mut self, gpu: &Gpu, tile: &MapTile) -> Result<MapPut, SceneError> {
        let MapTile { map, pyramid } = tile;
        let device = DeviceMap::new(map);
        let bays = map.vertices.iter().rev().map(|vertex| vertex.bays.to_bits());
        let words: Vec<u32> = bays.chain(device.words).collect();
        let bytes = size_of_val(&words[..]) as u64;
        let (words, grows_words) = self.words.put(gpu, &words)?;
        // Where the record lies is told by the room that the quads get.
        let count = quad_count(tile);
        let (quads, grows_quads) = match self.quads.take(gpu, count as u32) {
            Ok(taken) => taken,
            Err(error) => {
                self.words.free(words);
                return Err(error.into());
            }
        };
        let quad_base = quads.first + RECORD_QUADS + (roof_quads(map) * map.roofs.len()) as u32;
        let record = TileRecord {
            quad_base,
            word_base: words.first + map.vertices.len() as u32,
            min_height: pyramid.min_height(),
            max_height: pyramid.max_height(),
            block_base: quad_base + (pyramid.nodes().len() + map.vertices.len()) as u32,
            roof_quads: roof_quads(map) as u32,
            padding_a: 0,
            padding_b: 0,
        };
        let texels = quads_of(record, tile, &device.blocks);
        self.quads.fill(gpu, &quads, &texels);
        let slot = self.free.pop().unwrap_or(self.runs.len() as u32);
        if self.runs.len() <= slot as usize {
            self.runs.push(None);
        }
        self.runs[slot as usize] = Some([words, quads]);
        Ok(MapPut {
            slot,
            bytes: bytes + size_of_val(&texels[..]) as u64,
            is_new: grows_words || grows_quads,
        })
    }

    /// Where the record of a map lies in the quads.
    pub fn record_place(&self, slot: u32) -> u32 {
        let runs = self.runs.get(slot as usize).and_then(Option::as_ref);
        runs.map_or(0, |[_, quads]| quads.first)
    }

    /// Drops a map.
    pub fn drop(&mut self, slot: u32) {
        if let Some([words, quads]) = self.runs.get_mut(slot as usize).and_then(Option::take) {
            self.words.free(words);
            self.quads.free(quads);
            self.free.push(slot);
        }
    }

    /// Bytes of the maps in it.
    pub fn bytes_used(&self) -> u64 {
        self.words.bytes_used() + self.quads.bytes_used()
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.words.bytes() + self.quads.bytes()
    }
}

fn quad_count(MapTile { map, pyramid }: &MapTile) -> usize {
    RECORD_QUADS as usize
        + roof_quads(map) * map.roofs.len()
        + pyramid.nodes().len()
        + map.vertices.len()
        + map.occupied_count()
}

/// A map's record, its roofs, the last first, the nodes of its pyramid, its outline vertices, its occupied blocks.
fn quads_of(record: TileRecord, MapTile { map, pyramid }: &MapTile, blocks: &[[u32; 4]]) -> Vec<[u32; 4]> {
    let outlines = roof_outlines(map);
    let roofs = map.roofs.iter().zip(outlines).enumerate().rev();
    let roofs = roofs.flat_map(|(index, (roof, outline))| {
        let record = RoofRecord {
            base_m: roof.base_m,
            material: roof.material,
            roof_m: roof.roof_m,
            fid: roof.fid,
        };
        let vertices = (roof_quads(map) * (index + 1) + pyramid.nodes().len()) as u32;
        let outline = RoofOutline {
            vertex: vertices + outline.vertex,
            ..outline
        };
        let records = [bytemuck::cast::<_, [u32; 4]>(record), bytemuck::cast(outline)];
        records.into_iter().take(roof_quads(map))
    });
    let vertices = map.vertices.iter().map(|vertex| {
        let roof = &map.roofs[vertex.building as usize];
        VertexRecord {
            position: [vertex.x_m, vertex.y_m],
            roof_m: roof.roof_m,
            building: vertex.building,
        }
    });
    bytemuck::cast::<TileRecord, [[u32; 4]; RECORD_QUADS as usize]>(record)
        .into_iter()
        .chain(roofs)
        .chain(pyramid.nodes().iter().copied())
        .chain(vertices.map(bytemuck::cast))
        .chain(blocks.iter().copied())
        .collect()
}

/// Edges of an outline that may have a pitched roof: as many as there are bits.
const MAX_PITCHED_EDGES: usize = 32;

/// Each building's outline, its first vertex counted from the map's.
fn roof_outlines(map: &BuildingMap) -> Vec<RoofOutline> {
    let mut outlines = vec![RoofOutline::default(); map.roofs.len()];
    let is_edge = edges_named(map);
    let mut first = 0;
    for of_building in map.vertices.chunk_by(|a, b| a.building == b.building) {
        let edges = of_building.len() - 1;
        if edges <= MAX_PITCHED_EDGES {
            let gap = |edge: usize| u32::from(!is_edge[first + edge]) << edge;
            outlines[of_building[0].building as usize] = RoofOutline {
                vertex: first as u32,
                edges: edges as u32,
                gaps: (0..edges).map(gap).sum(),
                padding: 0,
            };
        }
        first += of_building.len();
    }
    outlines
}

/// Whether each vertex begins an edge that some texel has: what leads from one ring to the next, or past what lies outside the tile, no
/// texel has.
fn edges_named(map: &BuildingMap) -> Vec<bool> {
    let mut is_edge = vec![false; map.vertices.len()];
    let mut name = |code: u32| {
        if let CellKind::Run(run) = CellKind::from_code(code) {
            let first = run.first as usize;
            for named in is_edge.iter_mut().skip(first).take(run.edges as usize) {
                *named = true;
            }
        }
    };
    for (_, block) in map.blocks() {
        for &code in map.stored_codes(&block) {
            name(code);
            map.codes(code).iter().copied().for_each(&mut name);
        }
    }
    is_edge
}
