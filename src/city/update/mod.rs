//! Changes buildings of a finished city: the footprint dataset and the building-map tiles under old and new outlines, nothing
//! else. What comes out is what an import of the changed dataset on the same terrain gives, byte for byte.
//!
//! ```text
//! a file of changes, ids ─┐
//! the edited dataset ─────┴▶ changes (tiles that differ, footprints) ─▶ update_folder ─▶ transaction ─▶ city folder
//! ```

mod changes;
mod context;
mod lock;
mod parents;
mod tile_change;
mod transaction;
mod update_folder;

pub(super) use lock::{CityLock, is_at};
pub(super) use transaction::Pending;

use std::path::PathBuf;

use changes::{Changes, by_comparing, by_difference, from_file};
use context::{UpdateContext, stamp_of};
use transaction::{commit, finish_interrupted, set_not_older};
use update_folder::UpdateFolder;

use super::manifest::MAX_GENERATION;
use super::{City, CityError, Manifest};
use crate::source::FootprintReport;
use crate::space::Crs;

/// What to change.
#[derive(Clone, Debug)]
pub struct UpdateOptions {
    /// The city folder.
    pub city: PathBuf,
    /// Footprints to add, or to put over those with the same ids. Without it and without `delete` the footprint dataset is taken
    /// as it is now: it was edited.
    pub buildings: Option<PathBuf>,
    /// Their layer.
    pub layer: Option<String>,
    /// Their CRS, instead of what the file says.
    pub crs: Option<String>,
    /// Ids of buildings to take out.
    pub delete: Vec<u32>,
    /// A copy of the footprint dataset as the tiles show it: of an edited dataset only what differs from it is looked at.
    pub known: Option<PathBuf>,
    /// Changed footprints have the attributes that the file says and no others, instead of keeping those that it does not name.
    pub replaces_attributes: bool,
}

/// What an update did.
#[derive(Clone, Debug)]
pub struct UpdateReport {
    /// The city as it is now.
    pub manifest: Manifest,
    /// What became of the footprints that were read.
    pub footprints: FootprintReport,
    /// Buildings added, changed and taken out, where they were named; none where the dataset was compared.
    pub counts: Option<[u64; 3]>,
    /// Building-map tiles written.
    pub written: u64,
    /// Building-map tiles on which no building stands any more.
    pub removed: u64,
}

/// Updates a city. Waits for another update of the same city; finishes one that was interrupted.
///
/// # Errors
/// When a file cannot be read or written, or a change does not fit the city; the city is then as before.
pub fn update(options: &UpdateOptions) -> Result<UpdateReport, CityError> {
    let _lock = CityLock::acquire(&options.city)?;
    finish_interrupted(&options.city)?;
    let city = City::open(&options.city)?;
    let manifest = city.manifest();
    let ground = city.ground();
    let crs = Crs::from_text(&manifest.crs)?;
    let rules = city.facade_rules()?;
    let place = UpdateContext {
        city: &city,
        crs: &crs,
        ground: &ground,
        rules: &rules,
        dataset_stamp: stamp_of(&city.footprint_dataset_path()),
    };
    let folder = UpdateFolder::begin(&place)?;
    let changes = if options.buildings.is_none() && options.delete.is_empty() {
        let few = match &options.known {
            Some(known) => by_difference(&folder, known)?,
            None => None,
        };
        match few {
            Some(changes) => changes,
            None => by_comparing(&folder)?,
        }
    } else {
        from_file(&folder, options)?
    };
    let manifest = changed_manifest(manifest, &changes);
    if manifest.generation > MAX_GENERATION {
        return Err(CityError::File {
            path: options.city.join("city.toml"),
            why: "counts more updates than a city can have; import it again".to_owned(),
        });
    }
    if changes.is_empty() {
        // What was edited of the dataset changes no building.
        drop(folder);
        set_not_older(&options.city.join("city.toml"), &city.footprint_dataset_path())?;
    } else {
        commit(folder, &changes, &manifest)?;
    }
    let written = changes.tiles.iter().filter(|tile| tile.map.is_some()).count();
    Ok(UpdateReport {
        written: written as u64,
        removed: (changes.tiles.len() - written) as u64,
        counts: changes.counts,
        footprints: changes.read,
        manifest,
    })
}

fn changed_manifest(before: &Manifest, changes: &Changes) -> Manifest {
    let mut manifest = before.clone();
    if changes.is_empty() {
        return manifest;
    }
    manifest.generation += 1;
    for tile in &changes.tiles {
        let after = [tile.bytes(), u64::from(tile.map.is_some())];
        let before = [tile.bytes_before, u64::from(tile.was_there)];
        manifest.building_map_bytes = (manifest.building_map_bytes + after[0]).saturating_sub(before[0]);
        manifest.building_tiles = (manifest.building_tiles + after[1]).saturating_sub(before[1]);
    }
    if let Some([tiles, bytes]) = changes.totals {
        (manifest.building_tiles, manifest.building_map_bytes) = (tiles, bytes);
    }
    manifest.buildings = changes.buildings;
    manifest.triangle_bytes = changes.triangle_bytes;
    manifest.footprints = changes.report.clone();
    manifest
}
