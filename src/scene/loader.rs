//! Tiles from disk on worker threads.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::SystemTime;

use rayon::prelude::*;

use super::imagery_mips::imagery_mips;
use crate::buildings::{FootprintMask, MapTile};
use crate::city::{City, CityError, Layer, TerrainTile};
use crate::space::TileId;
use crate::terrain::GroundBounds;

/// One layer of one tile.
pub type TileKey = (Layer, TileId);

/// What a file of a tile holds.
pub enum Loaded {
    /// No file: nothing stands there.
    Nothing,
    /// Terrain and its maxima.
    Terrain(Box<(TerrainTile, GroundBounds)>),
    /// A building map, and where its buildings stand.
    Map(Box<(MapTile, FootprintMask)>),
    /// Imagery and its mip levels.
    Imagery(Vec<Vec<u8>>),
}

/// A tile read.
pub struct Reading {
    /// Which.
    pub key: TileKey,
    /// What told, before it was read, whether an update wrote its file.
    pub stamp: Option<(SystemTime, u64)>,
    /// What it holds, or why not.
    pub loaded: Result<Loaded, CityError>,
}

#[cfg(target_os = "linux")]
/// How much a thread stands back, in the system's steps.
const NICE: i32 = 10;
/// Most tiles on their way at a time.
const MAX_IN_FLIGHT: usize = 48;

/// Reads tiles.
pub struct Loader {
    sender: Sender<Reading>,
    receiver: Receiver<Reading>,
    in_flight: Vec<TileKey>,
    /// Threads that leave the processor time for frames; none where they could not be made.
    threads: Option<rayon::ThreadPool>,
}

impl Default for Loader {
    fn default() -> Self {
        let (sender, receiver) = channel();
        let cores = std::thread::available_parallelism().map_or(1, |count| count.get());
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads((cores / 2).max(1))
            .thread_name(|k| format!("tiles {k}"))
            .start_handler(|_| stand_back());
        Self {
            threads: threads.build().ok(),
            sender,
            receiver,
            in_flight: Vec::new(),
        }
    }
}

impl Loader {
    /// Asks for tiles, the first first, as many as may be on their way.
    pub fn request(&mut self, city: &Arc<City>, keys: &[TileKey]) {
        for &key in keys {
            if self.in_flight.len() >= MAX_IN_FLIGHT {
                break;
            }
            if self.in_flight.contains(&key) {
                continue;
            }
            self.in_flight.push(key);
            let (city, sender) = (Arc::clone(city), self.sender.clone());
            // Nobody waits for it any more when the city was closed.
            let work = move || drop(sender.send(read(&city, key)));
            match &self.threads {
                Some(threads) => threads.spawn(work),
                None => rayon::spawn(work),
            }
        }
    }

    /// The next tile that has come in.
    pub fn finished(&mut self) -> Option<Reading> {
        let reading = self.receiver.try_recv().ok()?;
        self.in_flight.retain(|&key| key != reading.key);
        Some(reading)
    }

    /// Tiles that are on their way.
    pub fn in_flight(&self) -> &[TileKey] {
        &self.in_flight
    }

    /// True when tiles are on their way.
    pub fn is_busy(&self) -> bool {
        !self.in_flight.is_empty()
    }
}

/// Lets frames go before what the calling thread does, where the system knows that of a thread.
pub fn stand_back() {
    #[cfg(target_os = "linux")]
    // Where it does not allow it, they share.
    let _ = rustix::process::nice(NICE);
}

/// Reads tiles at once, on all threads.
pub fn read_all(city: &City, keys: &[TileKey]) -> Vec<Reading> {
    keys.par_iter().map(|&key| read(city, key)).collect()
}

fn read(city: &City, key: TileKey) -> Reading {
    Reading {
        key,
        stamp: city.stamp(key.0, key.1),
        loaded: load(city, key),
    }
}

fn load(city: &City, (layer, id): TileKey) -> Result<Loaded, CityError> {
    Ok(match layer {
        Layer::Terrain => city.terrain(id)?.map(|terrain| {
            let bounds = GroundBounds::from_heights(&terrain.ground);
            Loaded::Terrain(Box::new((terrain, bounds)))
        }),
        Layer::Buildings => city.buildings(id)?.map(|map| {
            let footprints = FootprintMask::from_map(&map);
            Loaded::Map(Box::new((MapTile::new(map), footprints)))
        }),
        Layer::Imagery => city
            .imagery(id)?
            .map(|imagery| Loaded::Imagery(imagery_mips(imagery))),
    }
    .unwrap_or(Loaded::Nothing))
}
