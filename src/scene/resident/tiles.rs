//! Putting and dropping a tile: all that ever happens to one.

use std::time::SystemTime;

use super::{Entry, Resident, layer_index};
use crate::gpu::Gpu;
use crate::scene::loader::{Loaded, TileKey};
use crate::scene::tile_set::GroundTile;
use crate::scene::{IMAGERY, MAPS, SceneError, TERRAIN};
use crate::space::TileId;

impl Resident {
    /// Puts a tile.
    pub(super) fn put(
        &mut self,
        gpu: &Gpu,
        (layer, id): TileKey,
        stamp: Option<(SystemTime, u64)>,
        loaded: Loaded,
    ) -> Result<(), SceneError> {
        let is_root = id == self.root();
        let bounds = &mut self.tiles.bounds;
        let (slot, bytes) = match loaded {
            Loaded::Nothing => (None, 0),
            Loaded::Terrain(tile) => {
                let (terrain, maxima) = *tile;
                if is_root {
                    let [_, max] = terrain.ground.range().unwrap_or_default();
                    let error = self.terrain_errors.last().and_then(|errors| errors.first());
                    bounds.max_ground = max + error.copied().unwrap_or(0.0).max(0.0);
                    self.mesh_parts = terrain.ground.mesh_parts() as u32;
                }
                let indices: usize = terrain.meshes.iter().map(|mesh| 12 * mesh.len()).sum();
                let put = self.terrain.put(gpu, id, &terrain, &maxima)?;
                self.tiles.put_ground_bounds(put.0, Some(maxima.clone()));
                let ground = GroundTile {
                    heights: terrain.ground,
                    bounds: maxima,
                };
                if self.options.casts_rays {
                    self.tiles.put_ground(put.0, Some(ground));
                }
                (Some(put), self.terrain.tile_bytes() + indices as u64)
            }
            Loaded::Map(map) => {
                let (tile, footprints) = *map;
                if is_root {
                    [bounds.min_ground, bounds.max_roof] = tile.map.height_range;
                }
                let put = self.maps.put(gpu, &tile)?;
                self.tiles.put_roofs(put.slot, Some(tile.pyramid.clone()));
                self.tiles.put_footprints(put.slot, Some(footprints));
                if self.options.casts_rays {
                    self.tiles.put_map(put.slot, Some(tile));
                }
                (Some((put.slot, put.is_new)), put.bytes)
            }
            Loaded::Imagery(imagery) => {
                let put = self.imagery.put(gpu, &imagery)?;
                (Some(put), self.imagery.layers.image_bytes())
            }
        };
        self.bindings += u64::from(slot.is_some_and(|(_, is_new)| is_new));
        let entry = Entry {
            slot: slot.map(|(slot, _)| slot),
            bytes,
            wanted: self.views,
            stamp,
        };
        self.entries.insert((layer_index(layer), id), entry);
        self.is_stale = true;
        Ok(())
    }

    /// Drops a tile.
    pub(super) fn drop_tile(&mut self, layer: usize, id: TileId) {
        let Some(slot) = self.entries.remove(&(layer, id)).and_then(|entry| entry.slot) else {
            return;
        };
        match layer {
            MAPS => {
                self.maps.drop(slot);
                self.tiles.put_map(slot, None);
                self.tiles.put_roofs(slot, None);
                self.tiles.put_footprints(slot, None);
            }
            IMAGERY => self.imagery.layers.free(slot),
            _ => {
                self.terrain.drop(slot);
                self.tiles.put_ground(slot, None);
                self.tiles.put_ground_bounds(slot, None);
            }
        }
        self.is_stale = true;
    }

    /// Drops tiles that no view has wanted for longest until there is room for more tiles of each layer.
    pub(super) fn make_room(&mut self, coming: [usize; 3]) {
        let budget = self.options.budget - self.options.budget / 8;
        let mut used = self.bytes()
            + (0..coming.len())
                .map(|layer| coming[layer] as u64 * self.guess(layer))
                .sum::<u64>();
        let mut counts = coming;
        for ((layer, _), entry) in &self.entries {
            counts[*layer] += usize::from(entry.slot.is_some());
        }
        let is_full = |layer: usize, counts: &[usize; 3]| layer != MAPS && counts[layer] > self.max_layers;
        if used <= budget && !is_full(IMAGERY, &counts) && !is_full(TERRAIN, &counts) {
            return;
        }
        let root = self.root();
        let mut unwanted: Vec<(u64, usize, TileId, u64)> = (self.entries.iter())
            .filter(|((_, id), entry)| *id != root && entry.wanted < self.views && entry.slot.is_some())
            .map(|(&(layer, id), entry)| (entry.wanted, layer, id, entry.bytes))
            .collect();
        unwanted.sort_unstable();
        let mut dropped = Vec::new();
        for (_, layer, id, bytes) in unwanted {
            if used > budget || is_full(layer, &counts) {
                used -= bytes.min(used);
                counts[layer] -= 1;
                dropped.push((layer, id));
            }
        }
        for (layer, id) in dropped {
            self.drop_tile(layer, id);
        }
    }
}
