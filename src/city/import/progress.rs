//! How far an import is: a bar on standard error, when that is a terminal, and for who asks.

use std::fmt;
use std::sync::{Arc, Mutex};

use indicatif::{ProgressBar, ProgressStyle};

use crate::space::TileGrid;

/// How far an import is; copies tell of the same one.
#[derive(Clone, Default)]
pub struct ImportProgress(Arc<Mutex<Option<ProgressBar>>>);

impl fmt::Debug for ImportProgress {
    /// The same however far it is: what an import is asked is known by its options' text (`cache_key`).
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ImportProgress")
    }
}

/// A stage of an import.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportStage {
    /// Its name.
    pub name: String,
    /// Steps made.
    pub done: u64,
    /// Steps of all; none where that is not known.
    pub total: Option<u64>,
}

impl ImportProgress {
    /// A stage whose steps are counted; of how many is told by the bar's length.
    pub(super) fn begin(&self, name: &'static str) -> ProgressBar {
        self.show(name, "{prefix:12} {wide_bar} {pos}/{len} {eta}")
    }

    /// A stage of nobody knows how many steps.
    pub(super) fn count(&self, name: &'static str) -> ProgressBar {
        self.show(name, "{prefix:12} {pos}")
    }

    fn show(&self, name: &'static str, template: &str) -> ProgressBar {
        let bar = ProgressBar::no_length();
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_prefix(name);
        if let Ok(mut shown) = self.0.lock() {
            *shown = Some(bar.clone());
        }
        bar
    }

    /// The stage that it is in; none before the first.
    pub fn stage(&self) -> Option<ImportStage> {
        let shown = self.0.lock().ok()?;
        let bar = shown.as_ref()?;
        Some(ImportStage {
            name: bar.prefix(),
            done: bar.position(),
            total: bar.length(),
        })
    }
}

/// Tiles from which an import says beforehand what it will cost.
const MANY_TILES: u64 = 4000;
/// What a tile costs, about: seconds on two cores, and bytes by the samples of its ground.
const SECONDS_A_TILE: f64 = 0.04;
const BYTES_A_SAMPLE: f64 = 2.5;

/// Says on standard error what a large import will cost, and how it would cost less. `built_tiles`: those with buildings.
pub fn announce(grid: &TileGrid, terrain_side: usize, built_tiles: usize) {
    let tiles = u64::from(grid.columns) * u64::from(grid.rows);
    if tiles < MANY_TILES {
        return;
    }
    let tiles_f = tiles as f64;
    eprintln!(
        "import: {tiles} tiles of {:.0} m, about {:.0} minutes and {:.1} GB",
        grid.tile_m,
        (tiles_f * SECONDS_A_TILE / 60.0).max(1.0),
        tiles_f * BYTES_A_SAMPLE * (terrain_side * terrain_side) as f64 * 1e-9
    );
    let part = built_tiles as f64 / tiles_f;
    if part < 0.1 {
        eprintln!(
            "import: buildings stand on {:.1} % of them; parts far apart are better imported as cities of their own",
            100.0 * part
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_reads_the_same_however_far_it_is() {
        let progress = ImportProgress::default();
        let before = format!("{progress:?}");
        let bar = progress.begin("tiles");
        bar.set_length(7);
        bar.inc(3);
        assert_eq!(format!("{progress:?}"), before);
        let stage = ImportStage {
            name: "tiles".to_owned(),
            done: 3,
            total: Some(7),
        };
        assert_eq!(progress.stage(), Some(stage));
    }
}
