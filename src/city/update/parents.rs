//! The building maps of coarser levels over changed tiles.

use std::collections::{BTreeSet, HashMap};

use rayon::prelude::*;

use super::tile_change::TileChange;
use crate::buildings::{BuildingMap, coarser, coarser_updated};
use crate::city::{City, CityError};
use crate::space::TileId;

/// The tiles over changed ones whose maps become other ones, level after level. `before`: what `read_ancestors` gives for them.
pub fn changed_parents(
    city: &City,
    tiles: &[TileChange],
    mut before: HashMap<TileId, BuildingMap>,
) -> Result<Vec<TileChange>, CityError> {
    let grid = &city.manifest().grid;
    let mut parents: Vec<TileChange> = Vec::new();
    let mut below = 0..tiles.len();
    for level in 1..grid.levels() {
        let changed: HashMap<TileId, Option<&BuildingMap>> = match level {
            1 => tiles.iter().map(|tile| (tile.id, tile.map.as_ref())).collect(),
            _ => (parents[below].iter())
                .map(|tile| (tile.id, tile.map.as_ref()))
                .collect(),
        };
        let ids: BTreeSet<TileId> = changed.keys().map(|id| id.parent()).collect();
        let ids: Vec<_> = ids.into_iter().map(|id| (id, before.remove(&id))).collect();
        let parent = |(id, before): (TileId, Option<BuildingMap>)| {
            let read = || city.buildings(id).ok().flatten();
            let before = if level > LEVELS_AT_ONCE { read() } else { before };
            parent_change(city, id, before, &changed).transpose()
        };
        let next = ids.into_par_iter().filter_map(parent);
        let next = next.collect::<Result<Vec<TileChange>, CityError>>()?;
        below = parents.len()..parents.len() + next.len();
        parents.extend(next);
    }
    Ok(parents)
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
