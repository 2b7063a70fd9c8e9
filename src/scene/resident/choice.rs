//! Which tiles a view is given: those that it wants, as fine as the budget allows.

use std::collections::BTreeSet;

use super::{Resident, layer_of};
use crate::city::Layer;
use crate::scene::level_of_detail::DetailView;
use crate::scene::loader::TileKey;
use crate::scene::{IMAGERY, MAPS, TERRAIN};
use crate::space::{Projection, Sun, TileId};

impl Resident {
    /// The tiles that a view wants, as fine as the budget allows.
    pub(super) fn choose(&self, projection: &Projection, sun: &Sun) -> (DetailView, [Vec<TileId>; 3]) {
        let heights = self.tiles.bounds.heights();
        let mut coarser = 1.0;
        loop {
            let grid = self.tiles.grid;
            let view = DetailView::new(grid, projection, sun, heights, coarser);
            let imagery = match self.imagery.side {
                0 => Vec::new(),
                side => view.imagery(grid.tile_m / f64::from(side)),
            };
            let mut wanted = [Vec::new(), Vec::new(), Vec::new()];
            wanted[MAPS] = view.maps(self.texel_m);
            wanted[IMAGERY] = imagery;
            wanted[TERRAIN] = view.terrain(&self.terrain_errors);
            if self.fits(&wanted) || coarser > 1e4 {
                return (view, wanted);
            }
            coarser *= 1.25;
        }
    }

    /// Whether tiles are within the budget and the device's limits, as far as their sizes are known.
    pub(super) fn fits(&self, wanted: &[Vec<TileId>; 3]) -> bool {
        let layers = self.max_layers - self.max_layers / 8;
        let bytes = (wanted.iter().enumerate())
            .map(|(layer, ids)| self.bytes_of(layer, ids))
            .sum::<u64>();
        // Where frames do not wait, what lies over the leaves of a quadtree is held too: a third as many.
        let held = |leaves: usize| {
            if self.options.streams {
                leaves + leaves / 3
            } else {
                leaves
            }
        };
        bytes <= self.options.budget - self.options.budget / 8
            && held(wanted[TERRAIN].len()) < layers
            && held(wanted[IMAGERY].len()) < layers
    }

    /// About the bytes of a tile that was not read yet.
    pub(super) fn guess(&self, layer: usize) -> u64 {
        let manifest = self.city.manifest();
        match layer {
            // Of all tiles, also of those where nothing stands.
            MAPS => manifest.building_map_bytes / manifest.tile_count(Layer::Terrain).max(1),
            IMAGERY => self.imagery.layers.image_bytes(),
            _ => self.terrain.tile_bytes(),
        }
    }

    pub(super) fn bytes_of(&self, layer: usize, ids: &[TileId]) -> u64 {
        let guess = self.guess(layer);
        ids.iter()
            .map(|&id| self.entries.get(&(layer, id)).map_or(guess, |entry| entry.bytes))
            .sum()
    }

    /// The tiles that are wanted and not there: of a layer's quadtree the leaves or, where frames do not wait, also what lies over
    /// them, to stand for them. Notes that the others are wanted.
    pub(super) fn missing(&mut self) -> Vec<TileKey> {
        let (streams, views) = (self.options.streams, self.views);
        let mut missing = Vec::new();
        for (layer, leaves) in self.wanted.iter().enumerate() {
            let mut tiles: BTreeSet<TileId> = leaves.iter().copied().collect();
            let is_failed = |id: &TileId| self.failed.contains(&(layer, *id));
            // A tile that cannot be read is shown by what lies over it.
            let mut below: Vec<TileId> = match streams {
                true => leaves.clone(),
                false => leaves.iter().copied().filter(is_failed).collect(),
            };
            let top = self.tiles.grid.levels() - 1;
            while let Some(id) = below.pop() {
                if id.level == top {
                    continue;
                }
                let parent = id.parent();
                if tiles.insert(parent) && (streams || is_failed(&parent)) {
                    below.push(parent);
                }
            }
            for id in tiles {
                match self.entries.get_mut(&(layer, id)) {
                    Some(entry) => entry.wanted = views,
                    None if self.failed.contains(&(layer, id)) => {}
                    None => missing.push((layer_of(layer), id)),
                }
            }
        }
        missing
    }
}
