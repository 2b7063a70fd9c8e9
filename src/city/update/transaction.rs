//! An update on disk: all of it or nothing.
//!
//! New files are written to `update.partial` in the city folder. Renaming that to `update.commit` is the moment at which the city
//! becomes the new one: readers look there first. Then its files are moved into their places; an update that finds such a folder
//! finishes that first. Each of these steps can be done twice.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::changes::{Changes, Place, TileChange};
use crate::city::codec::write_buildings;
use crate::city::geotiff::GeoKeys;
use crate::city::{CityError, Layer, Manifest};
use crate::source::{FootprintDatasetEditor, FootprintDatasetWriter, FootprintSource};
use crate::space::TileId;

/// Folder of an update in the making.
pub const PARTIAL: &str = "update.partial";
/// Folder of an update that holds.
pub const COMMITTED: &str = "update.commit";
/// What an update takes away.
const PLAN: &str = "plan.toml";
/// Footprints that it puts into the dataset.
const FOOTPRINTS: &str = "footprints.gpkg";
const MANIFEST: &str = "city.toml";

/// What an update takes away.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Plan {
    /// Column and row of tiles on which no building stands any more.
    tiles: Vec<[u32; 2]>,
    /// Ids of buildings.
    buildings: Vec<u32>,
}

/// An update that holds and whose files are not in their places yet, as a reader needs it.
#[derive(Clone, Debug)]
pub struct Pending {
    folder: PathBuf,
    removed: HashSet<[u32; 2]>,
}

impl Pending {
    /// The pending update of a city folder; none without.
    pub fn find(city: &Path) -> Option<Self> {
        let folder = city.join(COMMITTED);
        let plan: Plan = toml::from_str(&fs::read_to_string(folder.join(PLAN)).ok()?).ok()?;
        Some(Self {
            folder,
            removed: plan.tiles.into_iter().collect(),
        })
    }

    /// The text of its manifest; none when it is in its place already.
    pub fn manifest(&self) -> Option<String> {
        fs::read_to_string(self.folder.join(MANIFEST)).ok()
    }

    /// Where a tile's new file lies before it is in its place.
    pub fn tile_path(&self, layer: Layer, tile: TileId) -> PathBuf {
        layer.tile_path(&self.folder, tile)
    }

    /// Whether the update takes a tile away.
    pub fn removes(&self, layer: Layer, tile: TileId) -> bool {
        layer == Layer::Buildings && self.removed.contains(&[tile.x, tile.y])
    }
}

/// An update in the making.
pub struct Transaction<'a> {
    place: &'a Place<'a>,
    folder: PathBuf,
}

impl<'a> Transaction<'a> {
    /// Begins an update; what an interrupted one left unfinished is thrown away.
    ///
    /// # Errors
    /// When the folder cannot be made.
    pub fn begin(place: &'a Place<'a>) -> Result<Self, CityError> {
        let folder = place.city.folder().join(PARTIAL);
        remove_folder(&folder)?;
        let tiles = folder.join(Layer::Buildings.name()).join("0");
        fs::create_dir_all(&tiles).map_err(CityError::file(&tiles))?;
        Ok(Self { place, folder })
    }

    /// Writes the changes and makes them hold.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn commit(self, changes: &Changes, manifest: &Manifest) -> Result<(), CityError> {
        let (city, crs) = (self.place.city.folder(), self.place.crs);
        let keys = GeoKeys::from_crs(crs)?;
        let mut plan = Plan {
            buildings: changes.deleted.clone(),
            ..Plan::default()
        };
        for tile in changes.tiles.iter().filter(|tile| tile.map.is_none()) {
            plan.tiles.push([tile.id.x, tile.id.y]);
        }
        let write = |tile: &TileChange| -> Result<(), CityError> {
            let Some(map) = &tile.map else { return Ok(()) };
            let path = Layer::Buildings.tile_path(&self.folder, tile.id);
            write_buildings(&path, &manifest.grid.tile_bounds(tile.id), map, &keys)
        };
        changes.tiles.par_iter().try_for_each(write)?;
        if let Some(source) = &changes.source
            && !changes.outlines.is_empty()
        {
            let mut dataset = FootprintDatasetWriter::create(&self.folder.join(FOOTPRINTS), crs)?;
            source.copy_to(&mut dataset, |fid| changes.outlines.get(&fid))?;
            dataset.finish()?;
        }
        for (name, text) in [
            (PLAN, toml::to_string_pretty(&plan)),
            (MANIFEST, toml::to_string_pretty(manifest)),
        ] {
            let path = self.folder.join(name);
            let text = text.map_err(|error| CityError::File {
                path: path.clone(),
                why: error.to_string(),
            })?;
            fs::write(&path, text).map_err(CityError::file(&path))?;
        }
        sync_all(&self.folder)?;
        let committed = city.join(COMMITTED);
        fs::rename(&self.folder, &committed).map_err(CityError::file(&committed))?;
        sync_folder(city)?;
        finish_interrupted(city)
    }
}

/// Moves the files of an update that holds into their places; nothing to do without one.
///
/// # Errors
/// When a file cannot be moved; the next update tries again.
pub fn finish_interrupted(city: &Path) -> Result<(), CityError> {
    let folder = city.join(COMMITTED);
    let plan_path = folder.join(PLAN);
    let Ok(text) = fs::read_to_string(&plan_path) else {
        // Nothing, or the rest of an update whose files are all in their places: the plan goes first.
        return remove_folder(&folder);
    };
    let plan: Plan = toml::from_str(&text).map_err(|error| CityError::File {
        path: plan_path.clone(),
        why: error.to_string(),
    })?;
    let footprints = folder.join(FOOTPRINTS);
    if footprints.exists() || !plan.buildings.is_empty() {
        let mut dataset = FootprintDatasetEditor::open(&city.join("buildings.gpkg"))?;
        if footprints.exists() {
            dataset.put_all(&FootprintSource::open_footprint_dataset(&footprints)?)?;
        }
        dataset.remove(&plan.buildings)?;
        dataset.finish()?;
    }
    let tiles = folder.join(Layer::Buildings.name()).join("0");
    let places = city.join(Layer::Buildings.name()).join("0");
    for entry in fs::read_dir(&tiles).map_err(CityError::file(&tiles))? {
        let entry = entry.map_err(CityError::file(&tiles))?;
        let place = places.join(entry.file_name());
        fs::rename(entry.path(), &place).map_err(CityError::file(&place))?;
    }
    for [x, y] in plan.tiles {
        let path = Layer::Buildings.tile_path(city, TileId { level: 0, x, y });
        if path.exists() {
            fs::remove_file(&path).map_err(CityError::file(&path))?;
        }
    }
    let manifest = folder.join(MANIFEST);
    if manifest.exists() {
        // Not older than the dataset: that would say that the dataset was edited.
        let file = fs::File::options().append(true).open(&manifest);
        file.and_then(|file| file.set_modified(std::time::SystemTime::now()))
            .map_err(CityError::file(&manifest))?;
        let place = city.join(MANIFEST);
        fs::rename(&manifest, &place).map_err(CityError::file(&place))?;
    }
    sync_folder(&places)?;
    sync_folder(city)?;
    fs::remove_file(&plan_path).map_err(CityError::file(&plan_path))?;
    remove_folder(&folder)
}

fn remove_folder(folder: &Path) -> Result<(), CityError> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(CityError::file(folder)(error)),
        _ => Ok(()),
    }
}

/// Makes every file under a folder durable.
fn sync_all(folder: &Path) -> Result<(), CityError> {
    for entry in fs::read_dir(folder).map_err(CityError::file(folder))? {
        let path = entry.map_err(CityError::file(folder))?.path();
        if path.is_dir() {
            sync_all(&path)?;
        } else {
            let file = fs::File::open(&path);
            file.and_then(|file| file.sync_all())
                .map_err(CityError::file(&path))?;
        }
    }
    sync_folder(folder)
}

/// Makes the names in a folder durable.
fn sync_folder(folder: &Path) -> Result<(), CityError> {
    if !cfg!(unix) {
        return Ok(());
    }
    let handle = fs::File::open(folder);
    handle
        .and_then(|handle| handle.sync_all())
        .map_err(CityError::file(folder))
}
