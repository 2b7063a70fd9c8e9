//! Which resident tile stands for which tile of the grid.

use std::collections::BTreeSet;

use super::Resident;
use crate::gpu::Gpu;
use crate::scene::tile_table::table_code;
use crate::scene::{MAP_RECORD, MAPS, TERRAIN};
use crate::space::TileId;

impl Resident {
    /// Writes which tile stands for which: the wanted ones where they are there, otherwise coarser or finer ones that are.
    pub(super) fn make_table(&mut self, gpu: &Gpu) {
        let root = self.root();
        self.ground_cover.clear();
        for layer in 0..self.wanted.len() {
            let mut open: BTreeSet<TileId> = BTreeSet::new();
            for leaf in &self.wanted[layer] {
                let mut id = *leaf;
                while id.level < root.level && open.insert(id.parent()) {
                    id = id.parent();
                }
            }
            let mut cover = Vec::new();
            self.cover(layer, root, &open, &mut cover);
            self.tiles.covers[layer].clear();
            for id in cover {
                let slot = self.entries.get(&(layer, id)).and_then(|entry| entry.slot);
                self.tiles.table.fill(layer, id, table_code(id.level, slot));
                self.tiles.covers[layer].extend(slot.map(|slot| (id, slot)));
                if layer == MAPS {
                    let place = slot.map_or(0, |slot| self.maps.record_place(slot));
                    self.tiles.table.fill(MAP_RECORD, id, place);
                }
                if layer == TERRAIN {
                    self.ground_cover.extend(slot);
                }
            }
        }
        self.tile_table.write(gpu, self.tiles.table.codes());
        self.coverage.update(gpu, &self.tiles);
        self.is_stale = false;
        self.tables += 1;
    }

    /// Resident tiles that together cover a tile, as fine as wanted; false when there are none. `open`: tiles of which finer ones are
    /// wanted.
    pub(super) fn cover(
        &self,
        layer: usize,
        id: TileId,
        open: &BTreeSet<TileId>,
        cover: &mut Vec<TileId>,
    ) -> bool {
        let grid = &self.tiles.grid;
        let is_resident = self.entries.contains_key(&(layer, id));
        if id.level > 0 && (open.contains(&id) || !is_resident) {
            let before = cover.len();
            let children = grid
                .children(id)
                .into_iter()
                .filter(|&child| grid.contains(child));
            if children
                .into_iter()
                .all(|child| self.cover(layer, child, open, cover))
            {
                return true;
            }
            cover.truncate(before);
        }
        if is_resident {
            cover.push(id);
        }
        is_resident
    }
}
