//! What an update changes: footprints, and the building-map tiles under them.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fs;
use std::path::Path;

use geo::MultiPolygon;
use rayon::prelude::*;

use super::UpdateOptions;
use crate::buildings::{Building, BuildingMap, Pyramid, triangle_bytes};
use crate::city::ground_cache::GroundCache;
use crate::city::raised_footprints::{building_map, buildings_by_tile, raise_on_tiles};
use crate::city::{City, CityError, Layer};
use crate::source::{CrsChoice, Footprint, FootprintReport, FootprintSource, Selection, SourceError};
use crate::space::{Crs, TileId};

/// The city to change, its CRS and its ground.
pub struct Place<'a> {
    /// The city.
    pub city: &'a City,
    /// Its CRS.
    pub crs: &'a Crs,
    /// Its ground.
    pub ground: &'a GroundCache,
}

/// A tile that becomes another one.
pub struct TileChange {
    /// Which.
    pub id: TileId,
    /// Bytes of its map when loaded; 0 without one.
    pub bytes_before: u64,
    /// Its new map; none where no building stands any more.
    pub map: Option<BuildingMap>,
}

impl TileChange {
    /// Bytes of the new map when loaded.
    pub fn bytes(&self) -> u64 {
        self.map.as_ref().map_or(0, map_bytes)
    }
}

fn map_bytes(map: &BuildingMap) -> u64 {
    (map.bytes() + Pyramid::bytes(map.side)) as u64
}

/// All that an update changes.
pub struct Changes {
    /// Tiles that differ.
    pub tiles: Vec<TileChange>,
    /// Where the attributes of changed footprints come from; none when only footprints are taken out.
    pub source: Option<FootprintSource>,
    /// Outlines to put into the dataset, by id.
    pub outlines: BTreeMap<u32, MultiPolygon<f64>>,
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
        self.tiles.is_empty() && self.outlines.is_empty() && self.deleted.is_empty()
    }
}

/// What the edited dataset says otherwise than the tiles.
pub fn by_comparing(place: &Place<'_>) -> Result<Changes, CityError> {
    let city = place.city;
    let manifest = city.manifest();
    let dataset = open_dataset(city)?;
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
    let tiles = changed_tiles(city, &ids, &by_tile)?;
    let outlines = buildings
        .iter()
        .filter(|building| stored_otherwise.contains(&building.fid))
        .map(|building| (building.fid, building.outline.clone()))
        .collect();
    Ok(Changes {
        tiles,
        source: Some(dataset),
        outlines,
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

/// What a file of footprints, and ids to take out, change.
pub fn from_file(place: &Place<'_>, options: &UpdateOptions) -> Result<Changes, CityError> {
    let city = place.city;
    let manifest = city.manifest();
    refuse_edited(city)?;
    let dataset = open_dataset(city)?;
    let source = options
        .buildings
        .as_ref()
        .map(|path| open_changes(place.crs, path, options))
        .transpose()?;
    if let Some(source) = &source {
        require_height_fields(city, &dataset, source)?;
    }
    let (after, read) = match &source {
        Some(source) => read_buildings(place, source, Selection::All, |_| {})?,
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
    let (mut buildings, _) = read_buildings(place, &dataset, Selection::Fids(&standing), |_| {})?;
    buildings.extend(after.iter().cloned());
    buildings.sort_by_key(|building| building.fid);
    let by_tile = buildings_by_tile(&manifest.grid, &buildings);
    let tiles = changed_tiles(city, &ids, &by_tile)?;

    let added = after.iter().filter(|building| !is_known(building.fid)).count() as u64;
    let left = manifest.buildings + added;
    if left <= deleted.len() as u64 {
        return Err(CityError::NoBuildings {
            path: city.footprint_dataset_path(),
            rejected: "all would be deleted".to_owned(),
        });
    }
    let bytes = |buildings: &[Building]| -> u64 {
        buildings
            .iter()
            .map(|building| triangle_bytes(&building.outline))
            .sum()
    };
    Ok(Changes {
        tiles,
        source,
        counts: Some([added, after.len() as u64 - added, deleted.len() as u64]),
        buildings: left - deleted.len() as u64,
        triangle_bytes: (manifest.triangle_bytes + bytes(&after)).saturating_sub(bytes(&before)),
        report: manifest.footprints.replaced(&read_before, &read),
        read,
        outlines: after
            .into_iter()
            .map(|building| (building.fid, building.outline))
            .collect(),
        deleted: deleted.into_iter().collect(),
    })
}

fn open_dataset(city: &City) -> Result<FootprintSource, CityError> {
    Ok(FootprintSource::open_footprint_dataset(&city.footprint_dataset_path())?.require_ids()?)
}

fn open_changes(own: &Crs, path: &Path, options: &UpdateOptions) -> Result<FootprintSource, CityError> {
    let given = options.crs.as_deref().map(Crs::from_text).transpose()?;
    let choice = CrsChoice::new(given, Some(own));
    Ok(FootprintSource::open(path, options.layer.as_deref(), &choice)?.require_ids()?)
}

/// Refuses changes without a field that gives the city's buildings their heights: a changed building would get another height
/// here than from the dataset, which keeps what the changes do not say.
fn require_height_fields(
    city: &City,
    dataset: &FootprintSource,
    changes: &FootprintSource,
) -> Result<(), CityError> {
    let (known, fields) = (dataset.field_names()?, changes.field_names()?);
    let has = |names: &[String], field: &str| names.iter().any(|name| name.eq_ignore_ascii_case(field));
    let rule = &city.manifest().height_rule;
    let missing = rule
        .fields()
        .into_iter()
        .find(|field| has(&known, &field.field) && !has(&fields, &field.field));
    match missing {
        Some(missing) => Err(CityError::Source(SourceError::NoField {
            path: changes.path().to_owned(),
            field: missing.field,
            fields,
        })),
        None => Ok(()),
    }
}

/// Footprints on the city's ground, by id, and what became of them.
fn read_buildings(
    place: &Place<'_>,
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
    let raised = raise_on_tiles(footprints, place.ground)?;
    raised.count_in(&mut report);
    Ok((raised.buildings, report))
}

/// Refuses changes to a dataset whose own edits are not in the tiles yet: they would be taken for old.
fn refuse_edited(city: &City) -> Result<(), CityError> {
    let time = |path| fs::metadata(path).and_then(|data| data.modified());
    let dataset = city.footprint_dataset_path();
    match (time(dataset.clone()), time(city.folder().join("city.toml"))) {
        (Ok(dataset_time), Ok(manifest_time)) if dataset_time > manifest_time => {
            Err(CityError::EditedDataset { path: dataset })
        }
        _ => Ok(()),
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

/// Those of some tiles whose maps are other ones than on disk.
fn changed_tiles(
    city: &City,
    ids: &[TileId],
    by_tile: &BTreeMap<TileId, Vec<&Building>>,
) -> Result<Vec<TileChange>, CityError> {
    let manifest = city.manifest();
    let changed = |&id: &TileId| -> Result<Option<TileChange>, CityError> {
        let map = by_tile.get(&id).map(|buildings| {
            building_map(&manifest.grid, id, manifest.tile_texels, buildings).map_err(|source| {
                CityError::TileTooLarge {
                    path: Layer::Buildings.tile_path(city.folder(), id),
                    source,
                }
            })
        });
        let map = map.transpose()?.flatten();
        // A damaged tile is one that differs.
        let before = city.buildings(id).ok().flatten();
        let is_there = city.has(Layer::Buildings, id);
        let is_same = before == map && is_there == map.is_some();
        Ok((!is_same).then(|| TileChange {
            id,
            bytes_before: before.as_ref().map_or(0, map_bytes),
            map,
        }))
    };
    let changes: Vec<Option<TileChange>> = ids.par_iter().map(changed).collect::<Result<_, _>>()?;
    Ok(changes.into_iter().flatten().collect())
}
