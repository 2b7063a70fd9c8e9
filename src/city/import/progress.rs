//! Progress bars on standard error, when that is a terminal.

use indicatif::{ProgressBar, ProgressStyle};

use crate::space::TileGrid;

/// A bar of `total` steps; a counter when `total` is 0.
pub fn progress(what: &'static str, total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total);
    let template = if total > 0 {
        "{prefix:12} {wide_bar} {pos}/{len} {eta}"
    } else {
        "{prefix:12} {pos}"
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_prefix(what);
    bar
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
