//! The building maps of coarser levels over changed tiles. Of each level the tiles are written beside the next one's making.

use std::collections::{BTreeSet, HashMap};

use rayon::prelude::*;

use super::tile_change::TileChange;
use super::update_folder::UpdateFolder;
use crate::buildings::{BuildingMap, coarser, coarser_updated};
use crate::city::{City, CityError};
use crate::space::TileId;

/// Writes changed tiles of a level, and those over them whose maps become other ones; these, level after level. `before`: what
/// `read_ancestors` gives for them.
pub fn write_with_parents(
    folder: &UpdateFolder<'_>,
    tiles: &[TileChange],
    before: HashMap<TileId, BuildingMap>,
) -> Result<Vec<TileChange>, CityError> {
    let parents = || {
        if tiles.is_empty() {
            return Ok(Vec::new());
        }
        let (mut parents, before) = parents_of(folder.context().city, tiles, before)?;
        let above = write_with_parents(folder, &parents, before)?;
        parents.extend(above);
        Ok(parents)
    };
    let (parents, written) = rayon::join(parents, || folder.write_tiles(tiles));
    written?;
    parents
}

/// The tiles of the next level whose maps become other ones; what is left of the maps before.
fn parents_of(
    city: &City,
    tiles: &[TileChange],
    mut before: HashMap<TileId, BuildingMap>,
) -> Result<(Vec<TileChange>, HashMap<TileId, BuildingMap>), CityError> {
    let level = tiles[0].id.level + 1;
    if level >= city.manifest().grid.levels() {
        return Ok((Vec::new(), before));
    }
    let changed: HashMap<TileId, Option<&BuildingMap>> =
        tiles.iter().map(|tile| (tile.id, tile.map.as_ref())).collect();
    let ids: BTreeSet<TileId> = changed.keys().map(|id| id.parent()).collect();
    let ids: Vec<_> = ids.into_iter().map(|id| (id, before.remove(&id))).collect();
    let parent = |(id, before): (TileId, Option<BuildingMap>)| {
        let read = || city.buildings(id).ok().flatten();
        let before = if level > LEVELS_AT_ONCE { read() } else { before };
        parent_change(city, id, before, &changed).transpose()
    };
    let parents = ids.into_par_iter().filter_map(parent);
    Ok((parents.collect::<Result<Vec<TileChange>, CityError>>()?, before))
}

/// Levels whose maps are read at once: farther up a change of a building or two is hardly ever seen.
const LEVELS_AT_ONCE: u32 = 3;

/// The maps over tiles on the first levels as they are, at once; without those that are damaged, which differ from any.
pub fn read_ancestors(city: &City, tiles: impl IntoIterator<Item = TileId>) -> HashMap<TileId, BuildingMap> {
    let mut ids: BTreeSet<TileId> = BTreeSet::new();
    for mut id in tiles {
        for _ in 1..city.manifest().grid.levels().min(1 + LEVELS_AT_ONCE) {
            id = id.parent();
            ids.insert(id);
        }
    }
    let read = |id: TileId| Some((id, city.buildings(id).ok().flatten()?));
    ids.into_par_iter().filter_map(read).collect()
}

/// A tile of a coarse level over changed ones; none when it stays the same.
fn parent_change(
    city: &City,
    id: TileId,
    before: Option<BuildingMap>,
    changed: &HashMap<TileId, Option<&BuildingMap>>,
) -> Result<Option<TileChange>, CityError> {
    let children = city.manifest().grid.children(id);
    let too_large = |source| CityError::TileTooLarge {
        path: city.footprint_dataset_path(),
        place: city.manifest().grid.tile_bounds(id).centre(),
        source,
    };
    let map = match &before {
        Some(before) => {
            let changed = children.map(|child| changed.get(&child).copied());
            let range = |k: usize| match changed[k] {
                Some(child) => Ok(child.map(|child| child.height_range)),
                None => city.height_range(children[k]),
            };
            let ranges = [range(0)?, range(1)?, range(2)?, range(3)?];
            coarser_updated(before, changed, ranges).map_err(too_large)?
        }
        None => {
            let read_child = |child: &TileId| match changed.contains_key(child) {
                true => Ok(None),
                false => city.buildings(*child),
            };
            let read = children.iter().map(read_child).collect::<Result<Vec<_>, _>>()?;
            let child = |k: usize| match changed.get(&children[k]) {
                Some(map) => *map,
                None => read[k].as_ref(),
            };
            coarser(std::array::from_fn(child)).map_err(too_large)?
        }
    };
    Ok(TileChange::between(city, id, before, map))
}
