//! The tile grid and the terrain's lattice of a city to be made.

use glam::DVec2;

use super::sources::Sources;
use super::{ImportOptions, TILE_TEXELS};
use crate::city::CityError;
use crate::source::{Footprint, FootprintReport};
use crate::space::{Bounds, TileGrid};

/// The tile grid and the terrain's lattice.
pub struct Plan {
    /// Tiles.
    pub grid: TileGrid,
    /// Samples along a tile's side.
    pub terrain_side: usize,
    /// Distance between samples, metres.
    pub terrain_step_m: f64,
    /// Longest run of missing samples that is filled.
    pub fill_samples: usize,
}

/// Distance between terrain samples at most, metres: the bilinear surface bends at the file's pixel centres, and where
/// samples cannot lie on those, a coarse lattice would cut the bends off (by a quarter of the step times the bend).
const MAX_STEP_M: f64 = 4.0;

/// Distance between samples where the city has few enough of them.
const CLOSE_STEP_M: f64 = 1.0;

/// Few enough samples: 64 MiB of heights.
const CLOSE_SAMPLES: f64 = 16e6;

/// Samples that a file's pixel gets at least, where its own cannot be used.
const SAMPLES_PER_PIXEL: f64 = 4.0;

/// Most intervals along a tile's side.
const MAX_INTERVALS: f64 = 1024.0;

/// Most tiles of a city.
const MAX_TILES: f64 = 1e6;

impl Plan {
    /// Tiles that cover the built-up part of the terrain and its surroundings.
    pub fn new(
        sources: &Sources,
        options: &ImportOptions,
        footprints: &[Footprint],
        report: &FootprintReport,
    ) -> Result<Self, CityError> {
        let terrain = sources.dtm.bounds_in(&sources.crs)?;
        let (mut built, mut all) = (Bounds::EMPTY, Bounds::EMPTY);
        for footprint in footprints {
            let bounds = outline_bounds(footprint);
            all = all.union(&bounds);
            if bounds.meets(&terrain) {
                built = built.union(&bounds);
            }
        }
        if report.read == 0 {
            return Err(CityError::EmptyLayer {
                path: options.buildings.clone(),
            });
        }
        let bounds = built.grown(options.margin_m).intersection(&terrain);
        if bounds.is_empty() {
            return Err(CityError::Apart {
                path: options.buildings.clone(),
                terrain: describe(&terrain),
                footprints: describe(&all),
                rejected: rejected(report),
            });
        }
        let tile_m = options.texel_m * TILE_TEXELS as f64;
        let tiles = (bounds.width() / tile_m + 1.0) * (bounds.height() / tile_m + 1.0);
        if tiles > MAX_TILES {
            return Err(CityError::TooManyTiles {
                tiles,
                extent: describe(&bounds),
            });
        }
        if let Some((anchor, pixel_m)) = sources.dtm.lattice_in(&sources.crs)
            && let Some(plan) = Self::on_pixels(&bounds, tile_m, anchor, pixel_m, options.fill_m)
        {
            return Ok(plan);
        }
        let wanted = (sources.dtm.finest_pixel_m() / SAMPLES_PER_PIXEL)
            .min(MAX_STEP_M)
            .max(0.5 * options.texel_m);
        let mut intervals = 16;
        while tile_m / intervals as f64 > wanted && (intervals as f64) < MAX_INTERVALS {
            intervals *= 2;
        }
        // A small city can afford closer samples, and with them a smaller part of its bends cut off.
        let samples = |intervals: usize| tiles * (intervals * intervals) as f64;
        while tile_m / intervals as f64 > CLOSE_STEP_M && samples(2 * intervals) <= CLOSE_SAMPLES {
            intervals *= 2;
        }
        // Bilinear needs both neighbours, so a hole of w metres is w + a pixel wide here.
        let fill_m = options.fill_m + sources.dtm.coarsest_pixel_m();
        let grid = TileGrid::covering(&bounds, tile_m, DVec2::ZERO, options.texel_m);
        let terrain_step_m = tile_m / intervals as f64;
        Ok(Self {
            grid,
            terrain_side: intervals + 1,
            terrain_step_m,
            fill_samples: if options.fill_m > 0.0 {
                (fill_m / terrain_step_m) as usize
            } else {
                0
            },
        })
    }

    /// Terrain samples on the file's own pixel centres (and whole fractions between), so that the city's ground is the
    /// file's to the last bit. The tile's side becomes the nearest whole number of pixels, and the texel follows it.
    fn on_pixels(bounds: &Bounds, tile_m: f64, anchor: DVec2, pixel_m: f64, fill_m: f64) -> Option<Self> {
        let pixels = (tile_m / pixel_m).round();
        let parts = (pixel_m / MAX_STEP_M).ceil().max(1.0);
        let side_m = pixels * pixel_m;
        let near_enough = (side_m / tile_m - 1.0).abs() < 0.25;
        // A hole is as wide as its pixels, and missing up to the known centres on both sides of it.
        let hole_samples = (fill_m / pixel_m).floor() * parts + parts - 1.0;
        (near_enough && pixels * parts <= MAX_INTERVALS).then(|| Self {
            grid: TileGrid::covering(bounds, side_m, anchor, pixel_m),
            terrain_side: (pixels * parts) as usize + 1,
            terrain_step_m: pixel_m / parts,
            fill_samples: if fill_m >= pixel_m {
                hole_samples as usize
            } else {
                0
            },
        })
    }
}

fn outline_bounds(footprint: &Footprint) -> Bounds {
    use geo::CoordsIter;
    let mut bounds = Bounds::EMPTY;
    for point in footprint.outline.exterior_coords_iter() {
        bounds.include(point.x, point.y);
    }
    bounds
}

/// How many features were read and why some became no building, for a message.
pub fn rejected(report: &FootprintReport) -> String {
    let reasons = report.rejected.iter();
    let reasons: String = reasons
        .map(|(why, count)| format!(", {count} left out: {why}"))
        .collect();
    format!("{} read{reasons}", report.read)
}

fn describe(bounds: &Bounds) -> String {
    if bounds.is_empty() {
        return "none".to_owned();
    }
    format!(
        "{:.0} to {:.0} east, {:.0} to {:.0} north",
        bounds.west, bounds.east, bounds.south, bounds.north
    )
}
