//! An update on disk: all of it or nothing.
//!
//! New files are written to `update.partial` in the city folder. Renaming that to `update.commit` is the moment at which the city
//! becomes the new one: readers look there first. Then its files are moved into their places; an update that finds such a folder
//! finishes that first. Each of these steps can be done twice.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

use super::changes::Changes;
use super::update_folder::{FOOTPRINTS, UpdateFolder, remove_folder};
use crate::city::city_files::{COMMITTED, MAX_TEXT, is_tile_name, read_plain_text};
use crate::city::durable::{create, sync, write};
use crate::city::{CityError, Layer, Manifest};
use crate::source::{FootprintDatasetEditor, FootprintSource, roll_back};
use crate::space::{Crs, TileId};

/// What an update takes away.
const PLAN: &str = "plan.toml";
const MANIFEST: &str = "city.toml";
/// Bytes of a block as file systems count them, and of holes in a dataset that is copied.
const SECTOR: u64 = 512;
const MAX_HOLES: u64 = 64 << 20;
/// The dataset while it is copied.
const COPY: &str = "dataset.gpkg";

/// What an update takes away.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Plan {
    /// Level, column and row of tiles on which no building stands any more.
    tiles: Vec<[u32; 3]>,
    /// Ids of buildings.
    buildings: Vec<u32>,
}

/// An update that holds and whose files are not in their places yet, as a reader needs it.
#[derive(Clone, Debug)]
pub struct Pending {
    folder: PathBuf,
    removed: HashSet<[u32; 3]>,
}

impl Pending {
    /// The pending update of a city folder; none without.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn find(city: &Path) -> Result<Option<Self>, CityError> {
        let folder = city.join(COMMITTED);
        Ok(read_plan(&folder)?.map(|plan| Self {
            folder,
            removed: plan.tiles.into_iter().collect(),
        }))
    }

    /// The text of its manifest; none when it is in its place already.
    pub fn manifest(&self) -> Option<String> {
        read_plain_text(&self.folder.join(MANIFEST), MAX_TEXT).ok()
    }

    /// Where a tile's new file lies before it is in its place.
    pub fn tile_path(&self, layer: Layer, tile: TileId) -> PathBuf {
        layer.tile_path(&self.folder, tile)
    }

    /// Whether the update takes a tile away.
    pub fn removes(&self, layer: Layer, tile: TileId) -> bool {
        layer == Layer::Buildings && self.removed.contains(&[tile.level, tile.x, tile.y])
    }
}

/// Makes changes hold whose tiles are written.
///
/// # Errors
/// When a file cannot be written.
pub fn commit(update: UpdateFolder<'_>, changes: &Changes, manifest: &Manifest) -> Result<(), CityError> {
    let city = update.context().city.folder();
    let mut plan = Plan {
        buildings: changes.deleted.clone(),
        ..Plan::default()
    };
    let tiles = changes.tiles.iter().chain(&changes.parents);
    for tile in tiles.filter(|tile| tile.map.is_none()) {
        plan.tiles.push([tile.id.level, tile.id.x, tile.id.y]);
    }
    for (name, text) in [
        (PLAN, toml::to_string_pretty(&plan)),
        (MANIFEST, toml::to_string_pretty(manifest)),
    ] {
        let path = update.path().join(name);
        let text = text.map_err(|error| CityError::File {
            path: path.clone(),
            why: error.to_string(),
        })?;
        write(&path, text.as_bytes()).map_err(CityError::file(&path))?;
    }
    sync(update.path())?;
    // What the dataset refuses is refused while the city is the old one.
    let dataset_path = update.context().city.footprint_dataset_path();
    require_plain(&dataset_path)?;
    let dataset = changed_dataset(
        &dataset_path,
        (&update.footprints(), Some(update.context().crs)),
        &plan.buildings,
        || update.context().require_dataset_unchanged(),
    )?;
    let committed = city.join(COMMITTED);
    fs::rename(update.path(), &committed).map_err(CityError::file(&committed))?;
    sync_folder(city)?;
    if let Some(dataset) = dataset {
        dataset.finish()?;
    }
    move_files(city, plan)
}

/// Moves the files of an update that holds into their places; nothing to do without one.
///
/// # Errors
/// When a file cannot be moved; the next update tries again.
pub fn finish_interrupted(city: &Path) -> Result<(), CityError> {
    let dataset_path = city.join("buildings.gpkg");
    roll_back(&dataset_path)?;
    let folder = city.join(COMMITTED);
    let manifest = folder.join(MANIFEST);
    // The manifest goes last: without it all files are in their places.
    let plan = match manifest.exists() {
        true => read_plan(&folder)?,
        false => None,
    };
    let Some(plan) = plan else {
        return remove_folder(&folder);
    };
    require_plain(&dataset_path)?;
    let footprints = folder.join(FOOTPRINTS);
    if let Some(dataset) = changed_dataset(&dataset_path, (&footprints, None), &plan.buildings, || Ok(()))? {
        dataset.finish()?;
    }
    move_files(city, plan)
}

/// The dataset with an update's changes in it, not committed yet; none where it changes nothing there. `check` is asked before the
/// first change, when nobody else can change it any more: what is not committed may be in the file already.
fn changed_dataset(
    path: &Path,
    (footprints, crs): (&Path, Option<&Crs>),
    deleted: &[u32],
    check: impl FnOnce() -> Result<(), CityError>,
) -> Result<Option<FootprintDatasetEditor>, CityError> {
    if !footprints.exists() && deleted.is_empty() {
        check()?;
        return Ok(None);
    }
    let copy = footprints.with_file_name(COPY);
    unshare(path, &copy)?;
    let mut dataset = FootprintDatasetEditor::open(path)?;
    check()?;
    if footprints.exists() {
        require_plain(footprints)?;
        dataset.put_all(&FootprintSource::open_footprint_dataset(footprints, crs)?)?;
    }
    dataset.remove(deleted)?;
    Ok(Some(dataset))
}

/// Gives a file that has other names, as in a backup of hard links, a copy of its own under this one. `copy`: where that is made.
fn unshare(path: &Path, copy: &Path) -> Result<(), CityError> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let data = fs::metadata(path).map_err(CityError::file(path))?;
        if data.nlink() > 1 {
            // To copy what is not there would fill the disk.
            if data.len() > MAX_HOLES + SECTOR * data.blocks() {
                return Err(CityError::File {
                    path: path.to_owned(),
                    why: "is mostly holes and has other names; make it a file of its own, with cp".to_owned(),
                });
            }
            let copied = || {
                let mut file = create(copy)?;
                std::io::copy(&mut fs::File::open(path)?, &mut file)?;
                // The time tells whether somebody edited it.
                file.set_modified(data.modified()?)?;
                file.sync_all()?;
                fs::rename(copy, path)
            };
            return copied().map_err(CityError::file(path));
        }
    }
    Ok(())
}

/// Moves the tiles and, last, the manifest of an update that holds.
fn move_files(city: &Path, plan: Plan) -> Result<(), CityError> {
    let folder = city.join(COMMITTED);
    let manifest = folder.join(MANIFEST);
    let dataset_path = city.join("buildings.gpkg");
    require_plain(&manifest)?;
    for layer_folder in [folder.as_path(), city].map(|folder| folder.join(Layer::Buildings.name())) {
        // A link could lead the writer out of the folder.
        require_plain(&layer_folder)?;
    }
    for level in 0.. {
        let [tiles, places] =
            [folder.as_path(), city].map(|folder| Layer::Buildings.level_path(folder, level));
        if !tiles.exists() {
            break;
        }
        move_level(&tiles, &places)?;
    }
    for [level, x, y] in plan.tiles {
        let path = Layer::Buildings.tile_path(city, TileId { level, x, y });
        if path.exists() {
            fs::remove_file(&path).map_err(CityError::file(&path))?;
        }
    }
    sync(city)?;
    set_not_older(&manifest, &dataset_path)?;
    sync(city)?;
    let place = city.join(MANIFEST);
    fs::rename(&manifest, &place).map_err(CityError::file(&place))?;
    sync_folder(city)?;
    remove_folder(&folder)
}

/// Moves the tiles of one level.
fn move_level(tiles: &Path, places: &Path) -> Result<(), CityError> {
    require_plain(tiles)?;
    require_plain(places)?;
    for entry in fs::read_dir(tiles).map_err(CityError::file(tiles))? {
        let entry = entry.map_err(CityError::file(tiles))?;
        if is_tile_name(&entry.file_name().to_string_lossy()) {
            let place = places.join(entry.file_name());
            fs::rename(entry.path(), &place).map_err(CityError::file(&place))?;
        }
    }
    Ok(())
}

/// Makes a manifest not older than the dataset: that would say that the dataset was edited.
pub fn set_not_older(manifest: &Path, dataset: &Path) -> Result<(), CityError> {
    let time_of = |path: &Path| {
        let time = fs::metadata(path).and_then(|data| data.modified());
        time.map_err(CityError::file(path))
    };
    let of_dataset = time_of(dataset)?;
    if time_of(manifest)? >= of_dataset {
        return Ok(());
    }
    let time = of_dataset.max(SystemTime::now());
    let file = fs::File::options().append(true).open(manifest);
    file.and_then(|file| file.set_modified(time))
        .map_err(CityError::file(manifest))
}

/// The plan of an update; none when there is none.
fn read_plan(folder: &Path) -> Result<Option<Plan>, CityError> {
    let path = folder.join(PLAN);
    if fs::symlink_metadata(folder).is_err() || fs::symlink_metadata(&path).is_err() {
        return Ok(None);
    }
    // Its own folder, not one that a link leads to.
    require_plain(folder)?;
    let text = read_plain_text(&path, MAX_TEXT)?;
    match toml::from_str(&text) {
        Ok(plan) => Ok(Some(plan)),
        Err(error) => Err(CityError::File {
            path,
            why: error.to_string(),
        }),
    }
}

/// Refuses a link.
fn require_plain(path: &Path) -> Result<(), CityError> {
    let data = fs::symlink_metadata(path).map_err(CityError::file(path))?;
    match data.is_symlink() {
        true => Err(CityError::File {
            path: path.to_owned(),
            why: "is a link; a city's files lie in its folder".to_owned(),
        }),
        false => Ok(()),
    }
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
