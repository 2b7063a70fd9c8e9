//! An opened city folder: finds and reads its tiles. Pure Rust, no GDAL.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::city_files::{COMMITTED, MAX_TEXT, read_plain_text, require_plain_folders, tile_place};
use super::codec::{self, Lattice, TerrainTile, TexelGrid};
use super::layer::Layer;
use super::rules_file::{own_tiles, rules_from_city};
use super::update::Pending;
use super::{CityError, ImageryTile, Manifest, Tile};
use crate::buildings::BuildingMap;
use crate::material::{FacadeRules, OwnTiles};
use crate::space::TileId;

/// A city on disk.
#[derive(Clone, Debug)]
pub struct City {
    folder: PathBuf,
    manifest: Manifest,
    /// An update whose files are not all in their places yet.
    pending: Option<Pending>,
}

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
            None => read_plain_text(&folder.join("city.toml"), MAX_TEXT)
                .map_err(|error| not_a_city(error.to_string()))?,
        };
        let manifest = Manifest::from_text(&text).map_err(not_a_city)?;
        require_plain_folders(folder, manifest.levels)?;
        if pending.is_some() {
            require_plain_folders(&folder.join(COMMITTED), manifest.levels)?;
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

    /// The tiles of the user's own facades that its rules name.
    ///
    /// # Errors
    /// When the rules or a picture cannot be read.
    pub fn own_facades(&self) -> Result<Vec<OwnTiles>, CityError> {
        own_tiles(&self.folder, &self.facade_rules()?)
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
        let found = self.count_tiles(layer)?;
        let expected = self.manifest.tile_count(layer);
        if found != expected {
            return Err(CityError::Tile {
                path: self.folder.join(layer.name()),
                why: format!("{found} tiles of {expected} are there"),
            });
        }
        match self.missing_parent(layer)? {
            None => Ok(()),
            Some(tile) => Err(CityError::Tile {
                path: layer.tile_path(&self.folder, tile),
                why: "it is not there".to_owned(),
            }),
        }
    }

    /// A tile of a coarse level that is not there though one of those it stands for is.
    fn missing_parent(&self, layer: Layer) -> Result<Option<TileId>, CityError> {
        let is_kept = layer != Layer::Imagery || self.manifest.imagery_side > 0;
        if self.pending.is_some() || !is_kept {
            return Ok(None);
        }
        let mut below = self.tiles_of_level(layer, 0)?;
        for level in 1..self.manifest.levels {
            let found = self.tiles_of_level(layer, level)?;
            let parents: BTreeSet<TileId> = below.iter().map(|tile| tile.parent()).collect();
            if let Some(missing) = parents.into_iter().find(|parent| !found.contains(parent)) {
                return Ok(Some(missing));
            }
            below = found;
        }
        Ok(None)
    }

    /// The tiles of a level whose files are there.
    fn tiles_of_level(&self, layer: Layer, level: u32) -> Result<BTreeSet<TileId>, CityError> {
        let folder = layer.level_path(&self.folder, level);
        let mut tiles = BTreeSet::new();
        for entry in std::fs::read_dir(&folder).map_err(CityError::file(&folder))? {
            let entry = entry.map_err(CityError::file(&folder))?;
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            let place = tile_place(&entry.file_name().to_string_lossy());
            tiles.extend(place.filter(|_| is_file).map(|[x, y]| TileId { level, x, y }));
        }
        Ok(tiles)
    }

    /// Tiles of the finest level that have a layer.
    fn count_tiles(&self, layer: Layer) -> Result<u64, CityError> {
        if self.pending.is_some() {
            let tiles = self.manifest.grid.tiles();
            return Ok(tiles.filter(|&tile| self.has(layer, tile)).count() as u64);
        }
        if layer == Layer::Imagery && self.manifest.imagery_side == 0 {
            return Ok(0);
        }
        // What is there, not what might be: a grid can have many more places than tiles.
        Ok(self.tiles_of_level(layer, 0)?.len() as u64)
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

    /// West and north border of a tile, metres.
    fn corner(&self, tile: TileId) -> [f64; 2] {
        let bounds = self.manifest.grid.tile_bounds(tile);
        [bounds.west, bounds.north]
    }

    /// Ground of a tile, none where the city has none.
    pub fn terrain(&self, tile: TileId) -> Result<Option<TerrainTile>, CityError> {
        let lattice = Lattice {
            side: self.manifest.terrain_side,
            step_m: self.manifest.terrain_step_m,
            level: tile.level,
            corner: self.corner(tile),
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
            corner: self.corner(tile),
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
            .map(|path| {
                codec::read_imagery(
                    &path,
                    self.manifest.imagery_side,
                    &self.manifest.grid.tile_bounds(tile),
                )
            })
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
