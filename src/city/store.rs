//! An opened city folder: finds and reads its tiles. Pure Rust, no GDAL.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::codec::{self, Lattice, TerrainTile, TexelGrid};
use super::layer::Layer;
use super::manifest::FORMAT;
use super::rules_file::rules_from_city;
use super::update::Pending;
use super::{CityError, ImageryTile, Manifest, Tile};
use crate::buildings::BuildingMap;
use crate::material::FacadeRules;
use crate::space::TileId;

/// A city on disk.
#[derive(Clone, Debug)]
pub struct City {
    folder: PathBuf,
    manifest: Manifest,
    /// An update whose files are not all in their places yet.
    pending: Option<Pending>,
}

/// Largest counts a manifest may ask a reader to allocate for.
const MAX_TILE_SAMPLES: usize = 8192;
/// Fewest texels along a tile's side: a group of blocks.
const MIN_TILE_TEXELS: usize = 16;

impl City {
    /// Opens a folder by its `city.toml`.
    pub fn open(folder: &Path) -> Result<Self, CityError> {
        let not_a_city = |why: String| CityError::NotACity {
            path: folder.to_owned(),
            why,
        };
        let pending = Pending::find(folder)?;
        let text = match pending.as_ref().and_then(Pending::manifest) {
            Some(text) => text,
            None => std::fs::read_to_string(folder.join("city.toml"))
                .map_err(|error| not_a_city(format!("city.toml: {error}")))?,
        };
        let manifest: Manifest =
            toml::from_str(&text).map_err(|error| not_a_city(format!("city.toml: {error}")))?;
        if manifest.format != FORMAT {
            return Err(not_a_city(format!(
                "its format is {}, this program reads {FORMAT}: import it again",
                manifest.format
            )));
        }
        let grid = &manifest.grid;
        let sane = manifest.tile_texels.is_power_of_two()
            && [manifest.tile_texels, manifest.terrain_side, manifest.imagery_side]
                .iter()
                .all(|&count| count <= MAX_TILE_SAMPLES)
            && manifest.terrain_side >= 2
            && (MIN_TILE_TEXELS..=BuildingMap::MAX_SIDE).contains(&manifest.tile_texels)
            && grid.columns > 0
            && grid.rows > 0
            && [grid.west, grid.south].iter().all(|edge| edge.abs() < 1e9)
            && (0.01..=1e4).contains(&manifest.texel_m)
            && (manifest.texel_m * manifest.tile_texels as f64 / grid.tile_m - 1.0).abs() < 1e-6
            && (manifest.terrain_step_m * (manifest.terrain_side - 1) as f64 / grid.tile_m - 1.0).abs()
                < 1e-6
            && manifest.place.latitude_deg.is_finite()
            && manifest.place.longitude_deg.is_finite()
            && grid.columns.max(grid.rows) <= 1 << 16
            && u64::from(grid.columns) * u64::from(grid.rows) <= 1 << 26
            && manifest.levels == grid.levels();
        if !sane {
            return Err(not_a_city("city.toml: its sizes are impossible".to_owned()));
        }
        Ok(Self {
            folder: folder.to_owned(),
            manifest,
            pending,
        })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// `city.toml`.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The city as it is on disk now, where an update changed it since it was opened.
    ///
    /// # Errors
    /// When it cannot be opened any more.
    pub fn updated(&self) -> Result<Option<Self>, CityError> {
        let now = Self::open(&self.folder)?;
        let (before, after) = (&self.manifest, &now.manifest);
        if before == after {
            return Ok(None);
        }
        // What an update leaves as it is.
        let kept = |manifest: &Manifest| {
            let Manifest {
                grid,
                tile_texels,
                terrain_side,
                imagery_side,
                terrain_tiles,
                imagery_tiles,
                ..
            } = manifest;
            (
                *grid,
                *tile_texels,
                [*terrain_side, *imagery_side],
                [*terrain_tiles, *imagery_tiles],
            )
        };
        if kept(before) != kept(after)
            || before.sources != after.sources
            || after.generation < before.generation
        {
            return Err(CityError::ImportedAnew {
                path: self.folder.clone(),
            });
        }
        Ok(Some(now))
    }

    /// The footprint dataset of record.
    pub fn footprint_dataset_path(&self) -> PathBuf {
        self.folder.join("buildings.gpkg")
    }

    /// The rules that give its buildings their facades: those of the folder's `facades.toml`, the project's own without one.
    ///
    /// # Errors
    /// When the file cannot be read or used.
    pub fn facade_rules(&self) -> Result<FacadeRules, CityError> {
        rules_from_city(&self.folder).map(|(rules, _)| rules)
    }

    /// A tile's path, when it exists as a plain file.
    fn existing(&self, layer: Layer, tile: TileId) -> Option<PathBuf> {
        // A link could lead the reader out of the folder.
        let plain = |path: PathBuf| {
            let kind = std::fs::symlink_metadata(&path).ok()?;
            kind.is_file().then_some(path)
        };
        if let Some(pending) = &self.pending {
            if pending.removes(layer, tile) {
                return None;
            }
            if let Some(path) = plain(pending.tile_path(layer, tile)) {
                return Some(path);
            }
        }
        plain(layer.tile_path(&self.folder, tile))
    }

    /// Fails when tiles that the manifest counts are gone.
    pub fn require_all_tiles(&self) -> Result<(), CityError> {
        Layer::ALL
            .into_iter()
            .try_for_each(|layer| self.require_tiles(layer))
    }

    /// The same for one layer.
    ///
    /// # Errors
    /// When some are gone.
    pub fn require_tiles(&self, layer: Layer) -> Result<(), CityError> {
        let tiles = self.manifest.grid.tiles();
        let found = tiles.filter(|&tile| self.has(layer, tile)).count() as u64;
        let expected = self.manifest.tile_count(layer);
        if found == expected {
            return Ok(());
        }
        Err(CityError::Tile {
            path: self.folder.join(layer.name()),
            why: format!("{found} tiles of {expected} are there"),
        })
    }

    /// True when the tile has this layer.
    pub fn has(&self, layer: Layer, tile: TileId) -> bool {
        let is_kept = layer != Layer::Imagery || self.manifest.imagery_side > 0;
        is_kept && self.existing(layer, tile).is_some()
    }

    /// Time and length of a layer's file, which tell whether an update wrote it; none without one.
    pub fn stamp(&self, layer: Layer, tile: TileId) -> Option<(SystemTime, u64)> {
        let data = std::fs::metadata(self.existing(layer, tile)?).ok()?;
        Some((data.modified().ok()?, data.len()))
    }

    /// Ground of a tile, none where the city has none.
    pub fn terrain(&self, tile: TileId) -> Result<Option<TerrainTile>, CityError> {
        let lattice = Lattice {
            side: self.manifest.terrain_side,
            step_m: self.manifest.terrain_step_m,
            level: tile.level,
        };
        self.existing(Layer::Terrain, tile)
            .map(|path| codec::read_terrain(&path, lattice))
            .transpose()
    }

    /// Building map of a tile, none where no building stands.
    pub fn buildings(&self, tile: TileId) -> Result<Option<BuildingMap>, CityError> {
        let texels = TexelGrid {
            side: self.manifest.tile_texels,
            texel_m: self.manifest.texel_m,
            level: tile.level,
        };
        let read = |path: &Path| codec::read_buildings(path, texels);
        let Some(path) = self.existing(Layer::Buildings, tile) else {
            return Ok(None);
        };
        // A pending update's file may just have been moved into its place.
        let place = Layer::Buildings.tile_path(&self.folder, tile);
        let map = match read(&path) {
            Err(_) if path != place && !path.exists() => read(&place)?,
            map => map?,
        };
        Ok(Some(map))
    }

    /// Lowest ground under and highest roof of a tile's buildings, metres; none where no building stands.
    pub fn height_range(&self, tile: TileId) -> Result<Option<[f32; 2]>, CityError> {
        self.existing(Layer::Buildings, tile)
            .map(|path| codec::read_height_range(&path, tile.level))
            .transpose()
    }

    /// Imagery of a tile, none where there is none.
    pub fn imagery(&self, tile: TileId) -> Result<Option<ImageryTile>, CityError> {
        self.existing(Layer::Imagery, tile)
            .filter(|_| self.manifest.imagery_side > 0)
            .map(|path| codec::read_imagery(&path, self.manifest.imagery_side))
            .transpose()
    }

    /// How far the terrain of every tile of a level departs from that of level 0, metres, row by row from the south; NaN without
    /// terrain. Nothing on level 0, where it does not.
    ///
    /// # Errors
    /// When the file is missing or damaged.
    pub fn terrain_errors(&self) -> Result<Vec<Vec<f32>>, CityError> {
        codec::read_terrain_errors(&Layer::Terrain.errors_path(&self.folder), &self.manifest.grid)
    }

    /// All layers of a tile.
    ///
    /// # Errors
    /// When a file of it is damaged.
    pub fn tile(&self, id: TileId) -> Result<Tile, CityError> {
        Ok(Tile::new(
            id,
            self.terrain(id)?,
            self.buildings(id)?,
            self.imagery(id)?,
        ))
    }
}
