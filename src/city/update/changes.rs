//! What an update changes: footprints, and the building-map tiles under them, which are written as they are made.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use geo::MultiPolygon;
use rayon::prelude::*;

use super::UpdateOptions;
use super::context::UpdateContext;
use super::parents::{read_ancestors, write_with_parents};
use super::tile_change::TileChange;
use super::update_folder::UpdateFolder;
use crate::buildings::{Building, BuildingMap, MapTile, triangle_bytes};
use crate::city::raised_footprints::{building_map, buildings_by_tile, raise_on_tiles};
use crate::city::rules_file::FACADES;
use crate::city::{City, CityError, Layer};
use crate::source::{
    CrsChoice, Footprint, FootprintDatasetEditor, FootprintDatasetWriter, FootprintReport, FootprintSource,
    HeightRule, Selection,
};
use crate::space::{Crs, TileId};

/// All that an update changes.
pub struct Changes {
    /// Tiles of level 0 that differ.
    pub tiles: Vec<TileChange>,
    /// Tiles of coarser levels that differ then.
    pub parents: Vec<TileChange>,
    /// Tiles with buildings and bytes of their maps, where all tiles were looked at.
    pub totals: Option<[u64; 2]>,
    /// Whether footprints were written that go into the dataset.
    pub changes_dataset: bool,
    /// Ids to take out of the dataset.
    pub deleted: Vec<u32>,
    /// Buildings that the city has then.
    pub buildings: u64,
    /// Bytes of them as triangles.
    pub triangle_bytes: u64,
    /// What became of all footprints of the city.
    pub report: FootprintReport,
    /// What became of those that were read.
    pub read: FootprintReport,
    /// Added, changed, taken out, where they were named.
    pub counts: Option<[u64; 3]>,
}

impl Changes {
    /// True when the city stays as it is.
    pub fn is_empty(&self) -> bool {
        self.tiles.is_empty() && !self.changes_dataset && self.deleted.is_empty()
    }
}

/// What the edited dataset says otherwise than the tiles; footprints whose outlines had to be repaired are written.
pub fn by_comparing(folder: &UpdateFolder<'_>) -> Result<Changes, CityError> {
    let place = folder.context();
    let city = place.city;
    let manifest = city.manifest();
    // A building stands on the ground of its city: with a tile of it gone the building would be gone as well.
    city.require_tiles(Layer::Terrain)?;
    let dataset = city.footprint_dataset()?;
    let mut stored_otherwise = HashSet::new();
    let (buildings, report) = read_buildings(place, &dataset, Selection::All, |footprint| {
        if !footprint.is_as_stored {
            stored_otherwise.insert(footprint.fid);
        }
    })?;
    if buildings.is_empty() {
        return Err(CityError::NoBuildings {
            path: city.footprint_dataset_path(),
            rejected: format!("{} read", report.read),
        });
    }
    let ids: Vec<TileId> = manifest.grid.tiles().collect();
    let by_tile = buildings_by_tile(&manifest.grid, &buildings);
    let (tiles, totals) = changed_tiles(place, &ids, &by_tile)?;
    let ancestors = read_ancestors(city, tiles.iter().map(|tile| tile.id));
    let parents = write_with_parents(folder, &tiles, ancestors)?;
    let repaired = |fid: u32| -> Option<&MultiPolygon<f64>> {
        let index = buildings
            .binary_search_by_key(&fid, |building| building.fid)
            .ok()?;
        stored_otherwise.contains(&fid).then(|| &buildings[index].outline)
    };
    let changes_dataset = buildings.iter().any(|building| repaired(building.fid).is_some());
    if changes_dataset {
        let mut writer = FootprintDatasetWriter::create(&folder.footprints(), place.crs)?;
        dataset.copy_to(&mut writer, repaired)?;
        writer.finish()?;
    }
    Ok(Changes {
        tiles,
        parents,
        totals: Some(totals),
        changes_dataset,
        deleted: Vec::new(),
        buildings: buildings.len() as u64,
        triangle_bytes: buildings
            .iter()
            .map(|building| triangle_bytes(&building.outline))
            .sum(),
        read: report.clone(),
        report,
        counts: None,
    })
}

/// What a file of footprints, and ids to take out, change; changed footprints are written.
pub fn from_file(folder: &UpdateFolder<'_>, options: &UpdateOptions) -> Result<Changes, CityError> {
    let place = folder.context();
    let footprints = &folder.footprints();
    let city = place.city;
    let manifest = city.manifest();
    refuse_edited(city)?;
    let dataset = city.footprint_dataset()?;
    let (after, read) = match &options.buildings {
        Some(path) => {
            let source = open_changes(place.crs, path, options)?;
            let (outlines, read) = read_outlines(place, &source)?;
            // As the dataset will hold them, so that heights come from what it will say.
            let mut merged = FootprintDatasetWriter::create(footprints, place.crs)?;
            source.merge_to(&mut merged, &dataset, (&outlines, options.replaces_attributes))?;
            merged.finish()?;
            let merged = FootprintSource::open_footprint_dataset(footprints, Some(place.crs))?;
            let (after, report) = read_buildings(place, &merged, Selection::All, |_| {})?;
            drop(merged);
            // What has no ground there becomes no building: the dataset keeps what it has of it.
            let is_building = |fid: u32| after.binary_search_by_key(&fid, |building| building.fid).is_ok();
            let groundless: Vec<u32> = outlines.into_keys().filter(|&fid| !is_building(fid)).collect();
            if !groundless.is_empty() {
                let mut editor = FootprintDatasetEditor::open(footprints)?;
                editor.remove(&groundless)?;
                editor.finish()?;
            }
            (after, report.after(read))
        }
        None => (Vec::new(), FootprintReport::new(&manifest.height_rule)),
    };
    let deleted: BTreeSet<u32> = options.delete.iter().copied().collect();
    if let Some(building) = after.iter().find(|building| deleted.contains(&building.fid)) {
        return Err(CityError::ChangedAndDeleted { fid: building.fid });
    }
    let named: BTreeSet<u32> = after
        .iter()
        .map(|building| building.fid)
        .chain(deleted.iter().copied())
        .collect();
    let fids: Vec<u32> = named.iter().copied().collect();
    let (before, read_before) = read_buildings(place, &dataset, Selection::Fids(&fids), |_| {})?;
    let is_known = |fid: u32| before.binary_search_by_key(&fid, |building| building.fid).is_ok();
    if let Some(&fid) = deleted.iter().find(|&&fid| !is_known(fid)) {
        return Err(CityError::NoBuilding {
            path: city.footprint_dataset_path(),
            fid,
        });
    }

    require_inside(city, &before, &after)?;
    let added = after.iter().filter(|building| !is_known(building.fid)).count() as u64;
    let left = manifest.buildings + added;
    if left <= deleted.len() as u64 {
        return Err(CityError::NoBuildings {
            path: city.footprint_dataset_path(),
            rejected: "all would be deleted".to_owned(),
        });
    }
    Ok(Changes {
        changes_dataset: !after.is_empty(),
        counts: Some([added, after.len() as u64 - added, deleted.len() as u64]),
        buildings: left - deleted.len() as u64,
        deleted: deleted.into_iter().collect(),
        ..replacing(folder, &dataset, (&before, &read_before), (after, read), &named)?
    })
}

/// The most footprints that are compared one by one; more are compared with all others.
const MAX_DIFFERENCES: usize = 2000;

/// What the edited dataset says otherwise than `known`, the copy of it that the tiles show. None where that is much, or the dataset is
/// to be repaired as well.
pub fn by_difference(folder: &UpdateFolder<'_>, known: &Path) -> Result<Option<Changes>, CityError> {
    let place = folder.context();
    let dataset = place.city.footprint_dataset()?;
    let [changed, removed] = dataset.differing(known)?;
    if changed.len() + removed.len() > MAX_DIFFERENCES {
        return Ok(None);
    }
    let known = FootprintSource::open_footprint_dataset(known, None)?.require_ids()?;
    let named: BTreeSet<u32> = changed.iter().chain(&removed).copied().collect();
    let fids: Vec<u32> = named.iter().copied().collect();
    let before = read_buildings(place, &known, Selection::Fids(&fids), |_| {})?;
    let mut is_as_stored = true;
    let after = read_buildings(place, &dataset, Selection::Fids(&changed), |footprint| {
        is_as_stored &= footprint.is_as_stored;
    })?;
    let manifest = place.city.manifest();
    let buildings = (manifest.buildings + after.0.len() as u64).saturating_sub(before.0.len() as u64);
    if !is_as_stored || buildings == 0 {
        return Ok(None);
    }
    Ok(Some(Changes {
        changes_dataset: false,
        counts: None,
        buildings,
        deleted: Vec::new(),
        ..replacing(folder, &dataset, (&before.0, &before.1), after, &named)?
    }))
}

/// The tiles and figures of a city in which some buildings become others. `named`: the ids of all of them.
fn replacing(
    folder: &UpdateFolder<'_>,
    dataset: &FootprintSource,
    (before, read_before): (&[Building], &FootprintReport),
    (after, read): (Vec<Building>, FootprintReport),
    named: &BTreeSet<u32>,
) -> Result<Changes, CityError> {
    let place = folder.context();
    let manifest = place.city.manifest();
    let touched: BTreeSet<TileId> = before
        .iter()
        .chain(&after)
        .flat_map(|building| manifest.grid.tiles_meeting(&building.bounds()))
        .collect();
    let ids: Vec<TileId> = touched.into_iter().collect();
    // All that stands on the touched tiles then.
    let mut standing = Vec::new();
    for id in &ids {
        standing.extend(dataset.fids_meeting(&manifest.grid.tile_bounds(*id))?);
    }
    standing.sort_unstable();
    standing.dedup();
    standing.retain(|fid| !named.contains(fid));
    let (mut buildings, _) = read_buildings(place, dataset, Selection::Fids(&standing), |_| {})?;
    buildings.extend(after.iter().cloned());
    buildings.sort_by_key(|building| building.fid);
    let by_tile = buildings_by_tile(&manifest.grid, &buildings);
    let (changed, ancestors) = rayon::join(
        || changed_tiles(place, &ids, &by_tile),
        || read_ancestors(place.city, ids.iter().copied()),
    );
    let (tiles, _) = changed?;
    let parents = write_with_parents(folder, &tiles, ancestors)?;
    let bytes = |buildings: &[Building]| -> u64 {
        buildings
            .iter()
            .map(|building| triangle_bytes(&building.outline))
            .sum()
    };
    Ok(Changes {
        tiles,
        parents,
        totals: None,
        changes_dataset: false,
        counts: None,
        buildings: manifest.buildings,
        triangle_bytes: (manifest.triangle_bytes + bytes(&after)).saturating_sub(bytes(before)),
        report: manifest.footprints.replaced(read_before, &read),
        read,
        deleted: Vec::new(),
    })
}

fn open_changes(own: &Crs, path: &Path, options: &UpdateOptions) -> Result<FootprintSource, CityError> {
    let given = options.crs.as_deref().map(Crs::from_text).transpose()?;
    let choice = CrsChoice::new(given, Some(own));
    Ok(FootprintSource::open(path, options.layer.as_deref(), &choice)?.require_ids()?)
}

/// Outlines by id, the first of each, and what became of the features.
fn read_outlines(
    place: &UpdateContext<'_>,
    source: &FootprintSource,
) -> Result<(BTreeMap<u32, MultiPolygon<f64>>, FootprintReport), CityError> {
    let mut outlines = BTreeMap::new();
    let to = (
        place.crs,
        &HeightRule::Default,
        place.city.manifest().default_height_m,
    );
    let mut report = source.read_selected(Selection::All, to, |footprint| {
        outlines.entry(footprint.fid).or_insert(footprint.outline);
    })?;
    report.duplicates = 0;
    Ok((outlines, report))
}

/// Footprints on the city's ground, by id, and what became of them.
fn read_buildings(
    place: &UpdateContext<'_>,
    source: &FootprintSource,
    selection: Selection<'_>,
    mut each: impl FnMut(&Footprint),
) -> Result<(Vec<Building>, FootprintReport), CityError> {
    let manifest = place.city.manifest();
    let to = (place.crs, &manifest.height_rule, manifest.default_height_m);
    let mut footprints = Vec::new();
    let mut report = source.read_selected(selection, to, |footprint| {
        each(&footprint);
        footprints.push(footprint);
    })?;
    let raised = raise_on_tiles(footprints, place.rules, place.ground)?;
    raised.count_in(&mut report);
    Ok((raised.buildings, report))
}

/// Refuses changes to a dataset whose own edits, or those of the facade rules, are not in the tiles yet: they would be taken for old.
fn refuse_edited(city: &City) -> Result<(), CityError> {
    let time = |path| fs::metadata(path).and_then(|data| data.modified());
    let Ok(manifest_time) = time(city.folder().join("city.toml")) else {
        return Ok(());
    };
    let files = [city.footprint_dataset_path(), city.folder().join(FACADES)];
    let is_edited = |path: &PathBuf| time(path.clone()).is_ok_and(|time| time > manifest_time);
    match files.into_iter().find(is_edited) {
        Some(path) => Err(CityError::EditedDataset { path }),
        None => Ok(()),
    }
}

/// Refuses buildings that come to reach beyond the tiles: an import would make more of them.
fn require_inside(city: &City, before: &[Building], after: &[Building]) -> Result<(), CityError> {
    let bounds = city.manifest().grid.bounds();
    let reaches_out = |building: &&Building| bounds.union(&building.bounds()) != bounds;
    let out_before: HashSet<u32> = before
        .iter()
        .filter(reaches_out)
        .map(|building| building.fid)
        .collect();
    let mut outside = after.iter().filter(reaches_out);
    match outside.find(|building| !out_before.contains(&building.fid)) {
        Some(building) => Err(CityError::OutsideCity {
            path: city.folder().to_owned(),
            fid: building.fid,
        }),
        None => Ok(()),
    }
}

/// Those of some tiles whose maps are other ones than on disk; and how many of them have maps then, and the bytes of those.
fn changed_tiles(
    place: &UpdateContext<'_>,
    ids: &[TileId],
    by_tile: &BTreeMap<TileId, Vec<&Building>>,
) -> Result<(Vec<TileChange>, [u64; 2]), CityError> {
    let city = place.city;
    let manifest = city.manifest();
    let totals = [const { AtomicU64::new(0) }; 2];
    let map_of = |id: TileId| -> Result<Option<BuildingMap>, CityError> {
        let map = by_tile.get(&id).map(|buildings| {
            building_map(&manifest.grid, id, manifest.tile_texels, buildings).map_err(|source| {
                CityError::TileTooLarge {
                    path: city.footprint_dataset_path(),
                    place: manifest.grid.tile_bounds(id).centre(),
                    source,
                }
            })
        });
        let lowest = match by_tile.contains_key(&id) {
            true => place.ground.tile(id)?.and_then(|ground| ground.range()),
            false => None,
        };
        let lowest = lowest.map_or(f32::INFINITY, |[lowest, _]| lowest);
        let map = map.transpose()?.flatten().map(|map| map.over_ground(lowest));
        if let Some(map) = &map {
            totals[0].fetch_add(1, Ordering::Relaxed);
            totals[1].fetch_add(MapTile::bytes_of(map), Ordering::Relaxed);
        }
        Ok(map)
    };
    let changed = |&id: &TileId| -> Result<Option<TileChange>, CityError> {
        // A damaged tile is one that differs.
        let (before, map) = rayon::join(|| city.buildings(id).ok().flatten(), || map_of(id));
        Ok(TileChange::between(city, id, before, map?))
    };
    let changes = ids.par_iter().filter_map(|id| changed(id).transpose());
    let changes = changes.collect::<Result<Vec<_>, _>>()?;
    Ok((changes, totals.map(AtomicU64::into_inner)))
}
