//! The tile pool: which of a city's tiles are on the device for drawing and on the CPU for rays, within a budget of bytes.
//!
//! ```text
//! view ─▶ level_of_detail (tiles wanted) ─▶ loader ─▶ put ─┬▶ map_pool, terrain_pool, imagery_pool (GPU) ─┐
//!                                                          └▶ tile_set (CPU: rays, picking) ──────────────┴▶ tile_table
//! ```
//! Putting and dropping a tile are all that ever happens to it; an update puts changed ones.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::SystemTime;

use glam::{DVec2, DVec3, Mat4};

use super::imagery_pool::ImageryPool;
use super::level_of_detail::DetailView;
use super::loader::{Loaded, Loader, Reading, TileKey, read_all};
use super::map_pool::MapPool;
use super::terrain_pool::{TerrainMesh, TerrainPool};
use super::tile_set::{GroundTile, TileSet};
use super::tile_table::table_code;
use super::{IMAGERY, MAP_RECORD, MAPS, SceneError, TERRAIN};
use crate::city::{City, Layer};
use crate::gpu::{Gpu, LayerPool, TableTexture};
use crate::space::{Projection, Sun, TileId};

/// How tiles are made resident.
#[derive(Clone, Copy, Debug)]
pub struct PoolOptions {
    /// Which triangles carry the ground.
    pub mesh: TerrainMesh,
    /// Bytes of tiles on the device.
    pub budget: u64,
    /// Tiles are held on the CPU as well: for picking, the sun's visible fraction, counting reads.
    pub casts_rays: bool,
    /// Frames do not wait for tiles: coarser ones stand for those that are on their way.
    pub streams: bool,
}

/// Bytes of tiles on the device unless said otherwise.
pub const DEFAULT_BUDGET: u64 = 1_000_000_000;

impl Default for PoolOptions {
    fn default() -> Self {
        Self {
            mesh: TerrainMesh::Tin,
            budget: DEFAULT_BUDGET,
            casts_rays: true,
            streams: false,
        }
    }
}

impl From<TerrainMesh> for PoolOptions {
    fn from(mesh: TerrainMesh) -> Self {
        Self {
            mesh,
            ..Self::default()
        }
    }
}

/// A tile in the pool.
struct Entry {
    /// Where; none where nothing stands.
    slot: Option<u32>,
    /// Bytes on the device.
    bytes: u64,
    /// The last view that wanted it.
    wanted: u64,
    /// What tells whether an update wrote its file.
    stamp: Option<(SystemTime, u64)>,
}

/// A resident city.
pub struct Resident {
    /// The tiles on the CPU.
    pub tiles: TileSet,
    /// The tile table on the device.
    pub tile_table: TableTexture,
    /// Terrain.
    pub terrain: TerrainPool,
    /// Building maps.
    pub maps: MapPool,
    /// Imagery.
    pub imagery: ImageryPool,
    /// Side of a texel of level 0, metres.
    pub texel_m: f64,
    /// Texels along a tile's side.
    pub tile_texels: u32,
    /// Distance between terrain samples of level 0, metres.
    pub terrain_step_m: f64,
    /// Terrain samples along a tile's side.
    pub terrain_side: u32,
    /// Parts that a terrain mesh divides a cell's side into.
    pub mesh_parts: u32,
    /// Bound on the error of the finest terrain mesh, metres.
    pub terrain_error_m: f64,
    city: Arc<City>,
    /// Most layers of an array texture.
    max_layers: usize,
    options: PoolOptions,
    terrain_errors: Vec<Vec<f32>>,
    entries: BTreeMap<(usize, TileId), Entry>,
    loader: Loader,
    /// What the last view wanted, by layer.
    wanted: [Vec<TileId>; 3],
    views: u64,
    /// What tells one view from another.
    last_view: Option<ViewKey>,
    /// Slots of the terrain tiles that stand in the table.
    ground_cover: Vec<u32>,
    /// Tiles that could not be read.
    failed: BTreeSet<(usize, TileId)>,
    /// What there is to say of tiles, once each.
    warnings: Vec<String>,
    /// Whether the table no longer tells what is resident.
    is_stale: bool,
    /// Counts how often what shaders are bound to was made anew.
    bindings: u64,
    /// Counts how often the table was written.
    tables: u64,
}

/// Projection, eye, direction to the sun, pixels.
type ViewKey = (Mat4, DVec3, DVec3, [u32; 2]);

/// Tiles read at a time: bounds the memory beside the pool's.
const BATCH: usize = 24;

fn layer_index(layer: Layer) -> usize {
    match layer {
        Layer::Buildings => MAPS,
        Layer::Imagery => IMAGERY,
        Layer::Terrain => TERRAIN,
    }
}

fn layer_of(index: usize) -> Layer {
    match index {
        MAPS => Layer::Buildings,
        IMAGERY => Layer::Imagery,
        _ => Layer::Terrain,
    }
}

impl Resident {
    /// An opened city, of which the coarsest tile is resident.
    ///
    /// # Errors
    /// When that is damaged, or the device cannot hold it.
    pub fn open(gpu: &Gpu, city: &City, options: PoolOptions) -> Result<Self, SceneError> {
        let manifest = city.manifest();
        let grid = manifest.grid;
        let mut warnings = Vec::new();
        if let Err(error) = city.require_all_tiles() {
            warnings.push(format!("{error}; the rest is shown"));
        }
        let terrain_errors = match grid.levels() {
            1 => Vec::new(),
            _ => city.terrain_errors()?,
        };
        let max = u64::from(gpu.device.limits().max_texture_dimension_2d);
        gpu.require("the tile grid", u64::from(grid.columns.max(grid.rows)), max)?;
        let mut resident = Self {
            tiles: TileSet::new(grid),
            tile_table: TableTexture::new(gpu, "tile table", [grid.columns, grid.rows]),
            terrain: TerrainPool::new(gpu, options.mesh, manifest.terrain_side as u32)?,
            maps: MapPool::new(gpu)?,
            imagery: ImageryPool::new(gpu, manifest.imagery_side as u32)?,
            texel_m: manifest.texel_m,
            tile_texels: manifest.tile_texels as u32,
            terrain_step_m: manifest.terrain_step_m,
            terrain_side: manifest.terrain_side as u32,
            mesh_parts: 1,
            terrain_error_m: manifest.terrain_error_m,
            city: Arc::new(city.clone()),
            max_layers: LayerPool::capacity(gpu) as usize,
            options,
            terrain_errors,
            entries: BTreeMap::new(),
            loader: Loader::default(),
            wanted: [const { Vec::new() }; 3],
            views: 0,
            last_view: None,
            ground_cover: Vec::new(),
            failed: BTreeSet::new(),
            warnings,
            is_stale: true,
            bindings: 0,
            tables: 0,
        };
        resident.load_root(gpu)?;
        Ok(resident)
    }

    fn root(&self) -> TileId {
        TileId {
            level: self.tiles.grid.levels() - 1,
            x: 0,
            y: 0,
        }
    }

    /// Loads the coarsest tile, which is never dropped.
    fn load_root(&mut self, gpu: &Gpu) -> Result<(), SceneError> {
        let root = self.root();
        let keys: Vec<TileKey> = Layer::ALL.into_iter().map(|layer| (layer, root)).collect();
        for reading in read_all(&self.city, &keys) {
            let Reading { key, stamp, loaded } = reading;
            self.put(gpu, key, stamp, loaded?)?;
        }
        self.wanted = [const { Vec::new() }; 3].map(|_: Vec<TileId>| vec![root]);
        self.make_table(gpu);
        Ok(())
    }

    /// Makes a view's tiles resident: all of them, or where frames do not wait some of them, and the others soon.
    ///
    /// # Errors
    /// When the device fails, or the city became another one.
    pub fn prepare(&mut self, gpu: &Gpu, projection: &Projection, sun: &Sun) -> Result<(), SceneError> {
        let key = (
            projection.clip_from_eye_relative(),
            projection.pose.eye,
            sun.to_sun,
            projection.size,
        );
        if self.last_view == Some(key) && !self.is_stale && !(self.options.streams && self.is_loading()) {
            return Ok(());
        }
        self.last_view = Some(key);
        self.views += 1;
        let (view, wanted) = self.choose(projection, sun);
        let is_changed = wanted != self.wanted;
        self.wanted = wanted;
        if self.options.streams {
            self.stream(gpu, &view)?;
        } else {
            self.load_all(gpu)?;
        }
        self.is_stale |= is_changed;
        if self.is_stale {
            self.make_table(gpu);
        }
        Ok(())
    }

    /// Makes all tiles of the finest level resident, whatever the budget: for rays that go anywhere.
    ///
    /// # Errors
    /// When the device cannot hold them.
    pub fn load_finest(&mut self, gpu: &Gpu) -> Result<(), SceneError> {
        self.views += 1;
        self.last_view = None;
        let tiles: Vec<TileId> = self.tiles.grid.tiles().collect();
        self.wanted = [const { Vec::new() }; 3].map(|_: Vec<TileId>| tiles.clone());
        let streams = std::mem::replace(&mut self.options.streams, false);
        let loaded = self.load_all(gpu);
        self.options.streams = streams;
        loaded?;
        self.make_table(gpu);
        Ok(())
    }

    /// True when tiles that the last view wants are not resident yet.
    pub fn is_loading(&self) -> bool {
        let is_missing = |layer: usize, id: &TileId| {
            !self.entries.contains_key(&(layer, *id)) && !self.failed.contains(&(layer, *id))
        };
        self.loader.is_busy()
            || (self.wanted.iter().enumerate()).any(|(layer, ids)| ids.iter().any(|id| is_missing(layer, id)))
    }

    /// The tiles that a view wants, as fine as the budget allows.
    fn choose(&self, projection: &Projection, sun: &Sun) -> (DetailView, [Vec<TileId>; 3]) {
        let bounds = self.tiles.bounds;
        let finite = |height: f32| {
            if height.is_finite() {
                f64::from(height)
            } else {
                0.0
            }
        };
        let low = finite(bounds.min_ground.min(bounds.max_ground));
        let high = finite(bounds.max_roof.max(bounds.max_ground));
        let mut coarser = 1.0;
        loop {
            let grid = self.tiles.grid;
            let view = DetailView::new(grid, projection, sun, [low, high], coarser);
            let imagery = match self.imagery.side {
                0 => Vec::new(),
                side => view.imagery(grid.tile_m / f64::from(side)),
            };
            let mut wanted = [Vec::new(), Vec::new(), Vec::new()];
            wanted[MAPS] = view.maps(self.texel_m);
            wanted[IMAGERY] = imagery;
            wanted[TERRAIN] = view.terrain(&self.terrain_errors);
            if self.fits(&wanted) || coarser > 1e4 {
                return (view, wanted);
            }
            coarser *= 1.25;
        }
    }

    /// Whether tiles are within the budget and the device's limits, as far as their sizes are known.
    fn fits(&self, wanted: &[Vec<TileId>; 3]) -> bool {
        let layers = self.max_layers - self.max_layers / 8;
        let bytes = (wanted.iter().enumerate())
            .map(|(layer, ids)| self.bytes_of(layer, ids))
            .sum::<u64>();
        bytes <= self.options.budget - self.options.budget / 8
            && wanted[TERRAIN].len() < layers
            && wanted[IMAGERY].len() < layers
    }

    /// About the bytes of a tile that was not read yet.
    fn guess(&self, layer: usize) -> u64 {
        let manifest = self.city.manifest();
        match layer {
            MAPS => manifest.building_map_bytes / manifest.building_tiles.max(1),
            IMAGERY => self.imagery.layers.image_bytes(),
            _ => self.terrain.tile_bytes(),
        }
    }

    fn bytes_of(&self, layer: usize, ids: &[TileId]) -> u64 {
        let guess = self.guess(layer);
        ids.iter()
            .map(|&id| self.entries.get(&(layer, id)).map_or(guess, |entry| entry.bytes))
            .sum()
    }

    /// The tiles that are wanted and not there: of a layer's quadtree the leaves or, where frames do not wait, also what lies over
    /// them, to stand for them. Notes that the others are wanted.
    fn missing(&mut self) -> Vec<TileKey> {
        let (streams, views) = (self.options.streams, self.views);
        let mut missing = Vec::new();
        for (layer, leaves) in self.wanted.iter().enumerate() {
            let mut tiles: BTreeSet<TileId> = leaves.iter().copied().collect();
            let is_failed = |id: &TileId| self.failed.contains(&(layer, *id));
            // A tile that cannot be read is shown by what lies over it.
            let mut below: Vec<TileId> = match streams {
                true => leaves.clone(),
                false => leaves.iter().copied().filter(is_failed).collect(),
            };
            let top = self.tiles.grid.levels() - 1;
            while let Some(id) = below.pop().filter(|id| id.level < top) {
                let parent = id.parent();
                if tiles.insert(parent) && (streams || is_failed(&parent)) {
                    below.push(parent);
                }
            }
            for id in tiles {
                match self.entries.get_mut(&(layer, id)) {
                    Some(entry) => entry.wanted = views,
                    None if self.failed.contains(&(layer, id)) => {}
                    None => missing.push((layer_of(layer), id)),
                }
            }
        }
        missing
    }

    /// Loads what is wanted and not there, all of it.
    fn load_all(&mut self, gpu: &Gpu) -> Result<(), SceneError> {
        let mut has_loaded = false;
        loop {
            let mut missing = self.missing();
            if missing.is_empty() {
                break;
            }
            // Layers and places mixed, so that the first few are like the rest.
            missing
                .sort_by_key(|(_, id)| (id.x.wrapping_mul(2_654_435_761) ^ id.y.wrapping_mul(40_503)) >> 3);
            has_loaded = true;
            let mut coming = [0; 3];
            for (layer, _) in &missing {
                coming[layer_index(*layer)] += 1;
            }
            self.make_room(coming);
            for (k, batch) in missing.chunks(BATCH).enumerate() {
                let readings = read_all(&self.city, batch);
                // The first few tell how much room the others take.
                let times = match k {
                    0 => missing.len() as f64 / batch.len() as f64,
                    _ => 1.0,
                };
                self.reserve(gpu, &readings, times)?;
                for reading in readings {
                    self.take(gpu, reading)?;
                }
                // So that the device frees the staging memory of the uploads.
                gpu.queue.submit([]);
                gpu.wait()?;
            }
        }
        if has_loaded && let Some(newer) = self.city.updated()? {
            self.take_buildings(gpu, &newer)?;
        }
        Ok(())
    }

    /// Makes room for tiles at once, as many times as those read, so that the pools do not grow for each of them.
    fn reserve(&mut self, gpu: &Gpu, readings: &[Reading], times: f64) -> Result<(), SceneError> {
        let mut maps = Vec::new();
        let mut terrain = Vec::new();
        let mut imagery = 0;
        for reading in readings {
            match &reading.loaded {
                Ok(Loaded::Map(map)) => maps.push(map.as_ref()),
                Ok(Loaded::Terrain(tile)) => terrain.push(&tile.0),
                Ok(Loaded::Imagery(_)) => imagery += 1,
                _ => {}
            }
        }
        let grows = [
            self.maps.reserve(gpu, &maps, times),
            self.terrain.reserve(gpu, &terrain, times)?,
            self.imagery
                .layers
                .reserve(gpu, (f64::from(imagery) * times) as u32)?,
        ];
        self.bindings += u64::from(grows.contains(&true));
        Ok(())
    }

    /// Takes what has come in and asks for more.
    fn stream(&mut self, gpu: &Gpu, view: &DetailView) -> Result<(), SceneError> {
        let finished = self.loader.finished();
        if !finished.is_empty() {
            self.make_room([finished.len(); 3]);
        }
        for reading in finished {
            self.take(gpu, reading)?;
        }
        let mut missing = self.missing();
        // The coarsest first, of those what is seen, the nearest first.
        missing.sort_by(|(_, a), (_, b)| {
            let (rank_a, rank_b) = (view.rank(*a), view.rank(*b));
            let seen = rank_a.0.cmp(&rank_b.0);
            seen.then(b.level.cmp(&a.level))
                .then(rank_a.1.total_cmp(&rank_b.1))
        });
        self.loader.request(&self.city, &missing);
        Ok(())
    }

    /// Puts what was read, or notes why it cannot be.
    fn take(&mut self, gpu: &Gpu, reading: Reading) -> Result<(), SceneError> {
        let Reading { key, stamp, loaded } = reading;
        let place = (layer_index(key.0), key.1);
        match loaded {
            // An update came in between: it is read again.
            Ok(_) if key.0 == Layer::Buildings && self.city.stamp(key.0, key.1) != stamp => Ok(()),
            Ok(_) if self.entries.contains_key(&place) => Ok(()),
            Ok(loaded) => self.put(gpu, key, stamp, loaded),
            Err(error) => {
                self.failed.insert(place);
                self.warnings
                    .push(format!("{error}; a coarser tile is shown in its place"));
                Ok(())
            }
        }
    }

    /// Puts a tile.
    fn put(
        &mut self,
        gpu: &Gpu,
        (layer, id): TileKey,
        stamp: Option<(SystemTime, u64)>,
        loaded: Loaded,
    ) -> Result<(), SceneError> {
        let is_root = id == self.root();
        let bounds = &mut self.tiles.bounds;
        let (slot, bytes) = match loaded {
            Loaded::Nothing => (None, 0),
            Loaded::Terrain(tile) => {
                let (terrain, maxima) = *tile;
                if is_root {
                    let [_, max] = terrain.ground.range().unwrap_or_default();
                    let error = self.terrain_errors.last().and_then(|errors| errors.first());
                    bounds.max_ground = max + error.copied().unwrap_or(0.0).max(0.0);
                    self.mesh_parts = terrain.ground.mesh_parts() as u32;
                }
                let indices: usize = terrain.meshes.iter().map(|mesh| 12 * mesh.len()).sum();
                let put = self.terrain.put(gpu, id, &terrain, &maxima)?;
                let ground = GroundTile {
                    heights: terrain.ground,
                    bounds: maxima,
                };
                if self.options.casts_rays {
                    self.tiles.put_ground(put.0, Some(ground));
                }
                (Some(put), self.terrain.tile_bytes() + indices as u64)
            }
            Loaded::Map(tile) => {
                if is_root {
                    [bounds.min_ground, bounds.max_roof] = tile.map.height_range;
                }
                let put = self.maps.put(gpu, &tile)?;
                if self.options.casts_rays {
                    self.tiles.put_map(put.slot, Some(*tile));
                }
                (Some((put.slot, put.is_new)), put.bytes)
            }
            Loaded::Imagery(imagery) => {
                let put = self.imagery.put(gpu, imagery)?;
                (Some(put), self.imagery.layers.image_bytes())
            }
        };
        self.bindings += u64::from(slot.is_some_and(|(_, is_new)| is_new));
        let entry = Entry {
            slot: slot.map(|(slot, _)| slot),
            bytes,
            wanted: self.views,
            stamp,
        };
        self.entries.insert((layer_index(layer), id), entry);
        self.is_stale = true;
        Ok(())
    }

    /// Drops a tile.
    fn drop_tile(&mut self, layer: usize, id: TileId) {
        let Some(slot) = self.entries.remove(&(layer, id)).and_then(|entry| entry.slot) else {
            return;
        };
        match layer {
            MAPS => {
                self.maps.drop(slot);
                self.tiles.put_map(slot, None);
            }
            IMAGERY => self.imagery.layers.free(slot),
            _ => {
                self.terrain.drop(slot);
                self.tiles.put_ground(slot, None);
            }
        }
        self.is_stale = true;
    }

    /// Drops tiles that no view has wanted for longest until there is room for more tiles of each layer.
    fn make_room(&mut self, coming: [usize; 3]) {
        let budget = self.options.budget - self.options.budget / 8;
        let mut used = self.bytes()
            + (0..coming.len())
                .map(|layer| coming[layer] as u64 * self.guess(layer))
                .sum::<u64>();
        let mut counts = coming;
        for ((layer, _), entry) in &self.entries {
            counts[*layer] += usize::from(entry.slot.is_some());
        }
        let is_full = |layer: usize, counts: &[usize; 3]| layer != MAPS && counts[layer] > self.max_layers;
        if used <= budget && !is_full(IMAGERY, &counts) && !is_full(TERRAIN, &counts) {
            return;
        }
        let root = self.root();
        let mut unwanted: Vec<(u64, usize, TileId, u64)> = (self.entries.iter())
            .filter(|((_, id), entry)| *id != root && entry.wanted < self.views && entry.slot.is_some())
            .map(|(&(layer, id), entry)| (entry.wanted, layer, id, entry.bytes))
            .collect();
        unwanted.sort_unstable();
        let mut dropped = Vec::new();
        for (_, layer, id, bytes) in unwanted {
            if used > budget || is_full(layer, &counts) {
                used -= bytes.min(used);
                counts[layer] -= 1;
                dropped.push((layer, id));
            }
        }
        for (layer, id) in dropped {
            self.drop_tile(layer, id);
        }
    }

    /// Writes which tile stands for which: the wanted ones where they are there, otherwise coarser or finer ones that are.
    fn make_table(&mut self, gpu: &Gpu) {
        let root = self.root();
        self.ground_cover.clear();
        for layer in 0..self.wanted.len() {
            let mut open: BTreeSet<TileId> = BTreeSet::new();
            for leaf in &self.wanted[layer] {
                let mut id = *leaf;
                while id.level < root.level && open.insert(id.parent()) {
                    id = id.parent();
                }
            }
            let mut cover = Vec::new();
            self.cover(layer, root, &open, &mut cover);
            for id in cover {
                let slot = self.entries.get(&(layer, id)).and_then(|entry| entry.slot);
                self.tiles.table.fill(layer, id, table_code(id.level, slot));
                if layer == MAPS {
                    let place = slot.map_or(0, |slot| self.maps.record_place(slot));
                    self.tiles.table.fill(MAP_RECORD, id, place);
                }
                if layer == TERRAIN {
                    self.ground_cover.extend(slot);
                }
            }
        }
        self.tile_table.write(gpu, self.tiles.table.codes());
        self.is_stale = false;
        self.tables += 1;
    }

    /// Resident tiles that together cover a tile, as fine as wanted; false when there are none. `open`: tiles of which finer ones are
    /// wanted.
    fn cover(&self, layer: usize, id: TileId, open: &BTreeSet<TileId>, cover: &mut Vec<TileId>) -> bool {
        let grid = &self.tiles.grid;
        let is_resident = self.entries.contains_key(&(layer, id));
        if id.level > 0 && (open.contains(&id) || !is_resident) {
            let before = cover.len();
            let children = grid
                .children(id)
                .into_iter()
                .filter(|&child| grid.contains(child));
            if children
                .into_iter()
                .all(|child| self.cover(layer, child, open, cover))
            {
                return true;
            }
            cover.truncate(before);
        }
        if is_resident {
            cover.push(id);
        }
        is_resident
    }

    /// Takes over the building maps of the city after an update: those resident whose files changed are read, ground and imagery stay.
    /// How many changed.
    ///
    /// # Errors
    /// When a tile is damaged, or the device cannot hold them.
    pub fn take_buildings(&mut self, gpu: &Gpu, city: &City) -> Result<usize, SceneError> {
        let is_changed = |id: &TileId, entry: &Entry| city.stamp(Layer::Buildings, *id) != entry.stamp;
        let keys: Vec<TileKey> = (self.entries.iter())
            .filter(|((layer, id), entry)| *layer == MAPS && is_changed(id, entry))
            .map(|(&(_, id), _)| (Layer::Buildings, id))
            .collect();
        // All are read before the first is put: a view is of the old city or the new one.
        let mut changed = Vec::new();
        for Reading { key, stamp, loaded } in read_all(city, &keys) {
            changed.push((key, stamp, loaded?));
        }
        self.city = Arc::new(city.clone());
        self.failed.retain(|(layer, _)| *layer != MAPS);
        let count = changed.len();
        for (key, stamp, loaded) in changed {
            self.drop_tile(MAPS, key.1);
            self.put(gpu, key, stamp, loaded)?;
        }
        self.make_table(gpu);
        gpu.queue.submit([]);
        gpu.wait()?;
        Ok(count)
    }

    /// Slots of the terrain tiles that are drawn: together they cover the city.
    pub fn ground_cover(&self) -> &[u32] {
        &self.ground_cover
    }

    /// Bytes of the resident tiles on the device.
    pub fn bytes(&self) -> u64 {
        self.entries.values().map(|entry| entry.bytes).sum()
    }

    /// Bytes of the resident building maps on the device.
    pub fn map_bytes(&self) -> u64 {
        let maps = self.entries.iter().filter(|((layer, _), _)| *layer == MAPS);
        maps.map(|(_, entry)| entry.bytes).sum()
    }

    /// Ground at a point of the city, metres.
    pub fn ground_at(&self, point: DVec2) -> Option<f64> {
        self.tiles.ground_at(point)
    }

    /// A number that changes when the resident tiles do.
    pub fn version(&self) -> u64 {
        self.tables
    }

    /// A number that changes when what shaders are bound to is made anew.
    pub fn bindings_version(&self) -> u64 {
        self.bindings
    }

    /// What there is to say of tiles since it was asked last.
    pub fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }
}
