//! The building maps of coarser levels over changed tiles.

use std::collections::{BTreeSet, HashMap};

use rayon::prelude::*;

use super::changes::TileChange;
use crate::buildings::{BuildingMap, coarser};
use crate::city::{City, CityError, Layer};
use crate::space::TileId;

/// The tiles over changed ones whose maps become other ones, level after level.
pub fn changed_parents(city: &City, tiles: &[TileChange]) -> Result<Vec<TileChange>, CityError> {
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
        let ids: Vec<TileId> = ids.into_iter().collect();
        let parent = |&id: &TileId| parent_change(city, id, &changed).transpose();
        let next = ids.par_iter().filter_map(parent);
        let next = next.collect::<Result<Vec<TileChange>, CityError>>()?;
        below = parents.len()..parents.len() + next.len();
        parents.extend(next);
    }
    Ok(parents)
}

/// A tile of a coarse level over changed ones; none when it stays the same.
fn parent_change(
    city: &City,
    id: TileId,
    changed: &HashMap<TileId, Option<&BuildingMap>>,
) -> Result<Option<TileChange>, CityError> {
    let children = city.manifest().grid.children(id);
    let read_child = |child: &TileId| match changed.contains_key(child) {
        true => Ok(None),
        false => city.buildings(*child),
    };
    // A damaged tile is one that differs.
    let (read, before) = rayon::join(
        || children.par_iter().map(read_child).collect::<Result<Vec<_>, _>>(),
        || city.buildings(id).ok().flatten(),
    );
    let read = read?;
    let child = |k: usize| match changed.get(&children[k]) {
        Some(map) => *map,
        None => read[k].as_ref(),
    };
    let map = coarser(std::array::from_fn(child)).map_err(|source| CityError::TileTooLarge {
        path: Layer::Buildings.tile_path(city.folder(), id),
        source,
    })?;
    Ok(TileChange::between(city, id, before, map))
}
