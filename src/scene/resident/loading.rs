//! Tiles on their way into the pool: all at once, or while frames go on.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{Resident, layer_index};
use crate::city::Layer;
use crate::gpu::Gpu;
use crate::scene::level_of_detail::DetailView;
use crate::scene::loader::{Loaded, Reading, TileKey, read_all};
use crate::scene::{MAPS, SceneError};
use crate::space::TileId;

/// Tiles read at a time, while as many that were read are put: bounds the memory beside the pool's.
const BATCH: usize = 24;
/// A frame that goes on takes tiles for no longer than this; the others have the next one.
const FRAME_TIME: Duration = Duration::from_millis(6);

impl Resident {
    /// Loads the coarsest tile, which is never dropped.
    pub(super) fn load_root(&mut self, gpu: &Gpu) -> Result<(), SceneError> {
        let root = self.root();
        let keys: Vec<TileKey> = Layer::ALL.into_iter().map(|layer| (layer, root)).collect();
        for reading in read_all(&self.city, &keys) {
            let Reading { key, stamp, loaded } = reading;
            self.put(gpu, key, stamp, loaded?)?;
        }
        self.wanted = [const { Vec::new() }; 3].map(|_: Vec<TileId>| vec![root]);
        self.make_table(gpu);
        Ok(())
    }

    /// Loads what is wanted and not there, all of it.
    pub(super) fn load_all(&mut self, gpu: &Gpu) -> Result<(), SceneError> {
        let mut has_loaded = false;
        loop {
            let mut missing = self.missing();
            if missing.is_empty() {
                break;
            }
            // Layers and places mixed, so that the first few are like the rest.
            missing
                .sort_by_key(|(_, id)| (id.x.wrapping_mul(2_654_435_761) ^ id.y.wrapping_mul(40_503)) >> 3);
            has_loaded = true;
            let mut coming = [0; 3];
            for (layer, _) in &missing {
                coming[layer_index(*layer)] += 1;
            }
            self.make_room(coming);
            let city = Arc::clone(&self.city);
            let mut batches = missing.chunks(BATCH);
            let mut read_next = || batches.next().map(|batch| read_all(&city, batch));
            let mut next = read_next();
            // The first few tell how much room the others take.
            let mut times = missing.len() as f64 / missing.len().min(BATCH) as f64;
            while let Some(readings) = next.take() {
                let (put, read) = rayon::join(|| self.take_all(gpu, readings, times), &mut read_next);
                put?;
                (next, times) = (read, 1.0);
            }
        }
        if has_loaded && let Some(newer) = self.city.updated()? {
            self.take_buildings(gpu, &newer)?;
        }
        Ok(())
    }

    /// Puts what was read; `times`: as many tiles are to come.
    fn take_all(&mut self, gpu: &Gpu, readings: Vec<Reading>, times: f64) -> Result<(), SceneError> {
        self.reserve(gpu, &readings, times)?;
        for reading in readings {
            self.take(gpu, reading)?;
        }
        // So that the device frees the staging memory of the uploads.
        gpu.queue.submit([]);
        gpu.wait()?;
        Ok(())
    }

    /// Makes room for tiles at once, as many times as those read, so that the pools do not grow for each of them.
    pub(super) fn reserve(&mut self, gpu: &Gpu, readings: &[Reading], times: f64) -> Result<(), SceneError> {
        let mut maps = Vec::new();
        let mut terrain = Vec::new();
        let mut imagery = 0;
        for reading in readings {
            match &reading.loaded {
                Ok(Loaded::Map(map)) => maps.push(&map.0),
                Ok(Loaded::Terrain(tile)) => terrain.push(&tile.0),
                Ok(Loaded::Imagery(_)) => imagery += 1,
                _ => {}
            }
        }
        let grows = [
            self.maps.reserve(gpu, &maps, times),
            self.terrain.reserve(gpu, &terrain, times)?,
            self.imagery
                .layers
                .reserve(gpu, (f64::from(imagery) * times) as u32)?,
        ];
        self.bindings += u64::from(grows.contains(&true));
        Ok(())
    }

    /// Makes room for tiles that are to come, by about their sizes: so that the pools do not grow again and again as they come.
    pub(super) fn reserve_for(&mut self, gpu: &Gpu, missing: &[TileKey]) -> Result<(), SceneError> {
        let count = |layer: Layer| missing.iter().filter(|(other, _)| *other == layer).count();
        let maps = count(Layer::Buildings) as u64 * self.guess(MAPS);
        let maps = maps.min(self.options.budget.saturating_sub(self.bytes()));
        let terrain = self.terrain.grow_a_part(gpu, count(Layer::Terrain) as u32)?;
        let imagery = self
            .imagery
            .layers
            .grow_a_part(gpu, count(Layer::Imagery) as u32)?;
        let grows = self.maps.reserve_bytes(gpu, maps) || terrain || imagery;
        self.bindings += u64::from(grows);
        Ok(())
    }

    /// Makes room for about half as many more tiles as there are, as the budget has it, a part at a time: while the view rests, so that
    /// no frame in motion has to.
    ///
    /// # Errors
    /// When the device fails.
    pub fn make_room_ahead(&mut self, gpu: &Gpu) -> Result<(), SceneError> {
        let mut rest = self.options.budget.saturating_sub(self.bytes());
        let mut ahead = |count: u32, bytes: u64| {
            let images = (count / 2).min(u32::try_from(rest / bytes.max(1)).unwrap_or(u32::MAX));
            rest -= u64::from(images) * bytes;
            images
        };
        let tiles = ahead(self.terrain.heights.count(), self.terrain.tile_bytes());
        let images = ahead(self.imagery.layers.count(), self.imagery.layers.image_bytes());
        let grows = self.terrain.grow_a_part(gpu, tiles)? || self.imagery.layers.grow_a_part(gpu, images)?;
        self.bindings += u64::from(grows);
        Ok(())
    }

    /// Takes what has come in and asks for more.
    pub(super) fn stream(&mut self, gpu: &Gpu, view: &DetailView) -> Result<(), SceneError> {
        let begun = Instant::now();
        // So that none of what this view wants makes room for what came in for it.
        self.missing();
        while begun.elapsed() < FRAME_TIME
            && let Some(reading) = self.loader.finished()
        {
            let mut coming = [0; 3];
            coming[layer_index(reading.key.0)] += 1;
            self.make_room(coming);
            self.take(gpu, reading)?;
        }
        let mut missing = self.missing();
        self.reserve_for(gpu, &missing)?;
        // The coarsest first, of those what is seen, the nearest first.
        missing.sort_by(|(_, a), (_, b)| {
            let (rank_a, rank_b) = (view.rank(*a), view.rank(*b));
            let seen = rank_a.0.cmp(&rank_b.0);
            seen.then(b.level.cmp(&a.level))
                .then(rank_a.1.total_cmp(&rank_b.1))
        });
        // As far as there is room, where that grows a part at a time.
        let mut room = [u32::MAX; 3];
        room[layer_index(Layer::Terrain)] = self.terrain.room(gpu);
        room[layer_index(Layer::Imagery)] = self.imagery.layers.room(gpu);
        for key in self.loader.in_flight() {
            // No longer wanted, it comes nevertheless.
            if !missing.contains(key) {
                let room = &mut room[layer_index(key.0)];
                *room = room.saturating_sub(1);
            }
        }
        missing.retain(|(layer, _)| {
            let room = &mut room[layer_index(*layer)];
            let fits = *room > 0;
            *room = room.saturating_sub(1);
            fits
        });
        self.loader.request(&self.city, &missing);
        Ok(())
    }

    /// Puts what was read, or notes why it cannot be.
    pub(super) fn take(&mut self, gpu: &Gpu, reading: Reading) -> Result<(), SceneError> {
        let Reading { key, stamp, loaded } = reading;
        let place = (layer_index(key.0), key.1);
        match loaded {
            // An update came in between: it is read again.
            Ok(_) if key.0 == Layer::Buildings && self.city.stamp(key.0, key.1) != stamp => Ok(()),
            Ok(_) if self.entries.contains_key(&place) => Ok(()),
            Ok(loaded) => self.put(gpu, key, stamp, loaded),
            Err(error) => {
                self.failed.insert(place);
                self.warnings
                    .push(format!("{error}; a coarser tile is shown in its place"));
                Ok(())
            }
        }
    }
}
