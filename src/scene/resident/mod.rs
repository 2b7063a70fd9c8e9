//! The tile pool: which of a city's tiles are on the device for drawing and on the CPU for rays, within a budget of bytes.
//!
//! ```text
//! view ─▶ level_of_detail (tiles wanted) ─▶ loader ─▶ put ─┬▶ map_pool, terrain_pool, imagery_pool (GPU) ─┐
//!                                                          └▶ tile_set (CPU: rays, picking) ──────────────┴▶ tile_table
//! ```
//! Putting and dropping a tile are all that ever happens to it; an update puts changed ones.

mod choice;
mod cover;
mod loading;
mod tiles;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use glam::{DVec2, DVec3, Mat4};

use crate::city::{City, Layer};
use crate::gpu::{Gpu, LayerPool, TableTexture};
use crate::scene::imagery_pool::ImageryPool;
use crate::scene::loader::{Loader, Reading, TileKey, read_all};
use crate::scene::map_pool::MapPool;
use crate::scene::site_coverage::SiteCoverage;
use crate::scene::terrain_pool::{TerrainMesh, TerrainPool};
use crate::scene::tile_set::TileSet;
use crate::scene::{IMAGERY, MAPS, SceneError, TERRAIN};
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
    /// Which part of the ground buildings cover.
    pub coverage: SiteCoverage,
    /// Terrain.
    pub terrain: TerrainPool,
    /// Building maps.
    pub maps: MapPool,
    /// Imagery.
    pub imagery: ImageryPool,
    /// Whether there are orthophotos in it.
    pub has_orthophotos: bool,
    /// Whether there are tiles without orthophotos, and no plan of streets.
    pub has_bare_ground: bool,
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
    /// When tiles were last taken while frames go on.
    last_stream: Option<Instant>,
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

/// Time between two looks at what has come in while frames go on, at least.
const STREAM_EVERY: Duration = Duration::from_millis(10);

/// Projection, eye, direction to the sun, pixels.
type ViewKey = (Mat4, DVec3, DVec3, [u32; 2]);

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
        let has_orthophotos = manifest
            .sources
            .iter()
            .any(|source| source.role == Layer::Imagery.name());
        let shows_all = manifest.tile_count(Layer::Imagery) >= manifest.tile_count(Layer::Terrain);
        let mut resident = Self {
            tiles: TileSet::new(grid),
            tile_table: TableTexture::new(gpu, "tile table", [grid.columns, grid.rows]),
            coverage: SiteCoverage::new(gpu, &grid)?,
            terrain: TerrainPool::new(gpu, options.mesh, manifest.terrain_side as u32)?,
            maps: MapPool::new(gpu)?,
            imagery: ImageryPool::new(gpu, manifest.imagery_side as u32)?,
            has_orthophotos,
            has_bare_ground: manifest.imagery_side == 0 || (has_orthophotos && !shows_all),
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
            last_stream: None,
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
        // A frame asks more than once.
        let has_come = self.last_stream.is_none_or(|last| last.elapsed() > STREAM_EVERY);
        let is_due = self.options.streams && has_come && self.is_loading();
        if self.last_view == Some(key) && !self.is_stale && !is_due {
            return Ok(());
        }
        self.last_view = Some(key);
        self.views += 1;
        let (view, wanted) = self.choose(projection, sun);
        let is_changed = wanted != self.wanted;
        self.wanted = wanted;
        if self.options.streams {
            self.stream(gpu, &view)?;
            self.last_stream = Some(Instant::now());
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

    /// Whether room is being made for tiles that are to come.
    pub fn is_making_room(&self) -> bool {
        let TerrainPool { heights, bounds, .. } = &self.terrain;
        let mut pools = [heights, bounds, &self.imagery.layers].into_iter();
        self.is_loading() && pools.any(|layers| layers.is_growing())
    }

    /// The fraction of the tiles that the last view wants which are resident, or cannot be read.
    pub fn loaded_fraction(&self) -> f32 {
        let wanted = || {
            self.wanted
                .iter()
                .enumerate()
                .flat_map(|(layer, ids)| ids.iter().map(move |id| (layer, *id)))
        };
        let is_there = |key: &(usize, TileId)| self.entries.contains_key(key) || self.failed.contains(key);
        match wanted().count() {
            0 => 1.0,
            count => wanted().filter(is_there).count() as f32 / count as f32,
        }
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

    /// Whether frames go on while tiles come.
    pub fn streams(&self) -> bool {
        self.options.streams
    }

    /// Resident tiles of all layers.
    pub fn count(&self) -> usize {
        self.entries.len()
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
