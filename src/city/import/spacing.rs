//! How far apart the terrain's samples lie, and the side of a tile.
//!
//! On the source's own samples where they are a lattice of the city: then the city's ground is the source's to the last bit.
//! Elsewhere (another CRS) no lattice lies on them, and one too coarse cuts off the bends at the source's pixel
//! centres, by a quarter of the step times the bend: there the coarsest step that does not, measured on the source itself.

use glam::DVec2;

use super::TILE_TEXELS;
use crate::city::CityError;
use crate::source::{Dtm, SampleLattice};
use crate::space::{Bounds, Crs, TileGrid};
use crate::terrain::HeightTile;

/// Most intervals along a tile's side.
const MAX_INTERVALS: usize = 1024;

/// A tile may be smaller or larger than asked for by this fraction, so that it is whole samples.
const TILE_TOLERANCE: f64 = 0.25;

/// Error of the lattice against the source that is promised, metres, and the fractions of the ground that may exceed it:
/// everywhere, and in the worst tile that is looked at.
const MAX_ERROR_M: f64 = 0.30;
const MAX_WORSE: f64 = 0.001;
const MAX_WORSE_IN_TILE: f64 = 0.01;
/// Error that the bases of buildings should not exceed, metres, and the fraction of the ground that may.
const MAX_BASE_ERROR_M: f64 = 0.10;
const MAX_WORSE_BASE: f64 = 0.002;

/// Step from which no finer one is tried, metres and fraction of a pixel.
const FINE_STEP_M: f64 = 4.0;
const FINE_PIXELS: f64 = 0.25;

/// The same where the city is so small that its samples are few, and how many those are (128 MiB of heights).
const CLOSE_STEP_M: f64 = 2.0;
const CLOSE_PIXELS: f64 = 0.125;
const CLOSE_SAMPLES: f64 = 32e6;

/// Tiles on which a step is tried, at most.
const TRIAL_TILES: usize = 64;

/// The terrain's lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// Tiles.
    pub grid: TileGrid,
    /// Sample intervals along a tile's side.
    pub intervals: usize,
    /// Distance between samples, metres.
    pub step_m: f64,
}

impl Spacing {
    /// Over the source's own samples. The tile's side becomes the number of them that is nearest to the one asked for.
    /// Samples farther apart than a tile are divided into whole parts, and of ones too close every n-th is used.
    pub fn on_samples(bounds: &Bounds, wanted_tile_m: f64, lattice: &SampleLattice) -> Self {
        let intervals = |step_m: f64| ((wanted_tile_m / step_m).round() as usize).clamp(1, MAX_INTERVALS);
        let fits = |step_m: f64| {
            let tile_m = intervals(step_m) as f64 * step_m;
            (tile_m / wanted_tile_m - 1.0).abs() <= TILE_TOLERANCE
        };
        let every = (wanted_tile_m / (lattice.step_m * MAX_INTERVALS as f64) - 0.01)
            .ceil()
            .max(1.0);
        let mut parts = 1.0;
        while !fits(lattice.step_m * every / parts) {
            parts += 1.0;
        }
        let step_m = lattice.step_m * every / parts;
        let intervals = intervals(step_m);
        Self {
            grid: TileGrid::covering(bounds, intervals as f64 * step_m, lattice.anchor, lattice.step_m),
            intervals,
            step_m,
        }
    }

    /// The coarsest lattice, by halves of the tile, that follows a source whose samples are no lattice of the city.
    pub fn measured(bounds: &Bounds, texel_m: f64, dtm: &Dtm, crs: &Crs) -> Result<Self, CityError> {
        let tile_m = texel_m * TILE_TEXELS as f64;
        let grid = TileGrid::covering(bounds, tile_m, DVec2::ZERO, texel_m);
        let pixel_m = dtm.finest_pixel_m();
        let halved = |limit_m: f64| {
            let intervals = (tile_m / limit_m).max(1.0) as usize;
            intervals.next_power_of_two().min(MAX_INTERVALS)
        };
        let coarsest = halved(1.2 * pixel_m);
        let limit = |pixels: f64, step_m: f64| {
            halved((pixels * pixel_m).min(step_m).max(0.5 * texel_m)).max(coarsest)
        };
        let samples = |intervals: usize| {
            f64::from(grid.columns) * f64::from(grid.rows) * (intervals * intervals) as f64
        };
        let close = limit(CLOSE_PIXELS, CLOSE_STEP_M);
        let finest = if samples(close) <= CLOSE_SAMPLES {
            close
        } else {
            limit(FINE_PIXELS, FINE_STEP_M)
        };
        let mut intervals = coarsest;
        if intervals < finest {
            let trial = Trial::sample(&grid, finest, dtm, crs)?;
            while intervals < finest && !trial.is_followed_by(finest / intervals) {
                intervals *= 2;
            }
        }
        Ok(Self {
            grid,
            intervals,
            step_m: tile_m / intervals as f64,
        })
    }
}

/// Ground of some of the tiles, on the finest lattice.
struct Trial {
    tiles: Vec<HeightTile>,
}

impl Trial {
    fn sample(grid: &TileGrid, intervals: usize, dtm: &Dtm, crs: &Crs) -> Result<Self, CityError> {
        let mut sampler = dtm.sampler(crs)?;
        let count = grid.columns as usize * grid.rows as usize;
        let step_m = grid.tile_m / intervals as f64;
        let mut tiles = Vec::new();
        for id in grid.tiles().step_by(count.div_ceil(TRIAL_TILES)) {
            let first = [id.x, id.y].map(|index| i64::from(index) * intervals as i64);
            let corner = DVec2::new(grid.west, grid.south);
            tiles.push(HeightTile {
                side: intervals + 1,
                level: 0,
                step_m,
                heights: sampler.lattice(corner, step_m, first, [intervals + 1; 2])?,
            });
        }
        Ok(Self { tiles })
    }

    /// True when every `stride`-th sample carries the ground between.
    fn is_followed_by(&self, stride: usize) -> bool {
        let fractions = self.tiles.iter().filter_map(|tile| fractions_off(tile, stride));
        let (mut sum, mut sum_base, mut worst, mut count) = (0.0, 0.0, 0.0_f64, 0.0);
        for [fraction, fraction_base] in fractions {
            sum += fraction;
            sum_base += fraction_base;
            worst = worst.max(fraction);
            count += 1.0;
        }
        sum <= MAX_WORSE * count && worst <= MAX_WORSE_IN_TILE && sum_base <= MAX_WORSE_BASE * count
    }
}

/// Fractions of a tile's samples that lie too far from the surface over every `stride`-th, for the ground and for bases of
/// buildings; none without ground.
fn fractions_off(tile: &HeightTile, stride: usize) -> Option<[f64; 2]> {
    let side = (tile.side - 1) / stride + 1;
    let coarse = HeightTile {
        side,
        level: 0,
        step_m: tile.step_m * stride as f64,
        heights: (0..side * side)
            .map(|k| tile.heights[(k / side) * stride * tile.side + (k % side) * stride])
            .collect(),
    };
    let surface = coarse.refined(stride);
    let errors = surface
        .heights
        .iter()
        .zip(&tile.heights)
        .map(|(a, b)| f64::from((a - b).abs()));
    let (mut off, mut off_base, mut known) = (0.0, 0.0, 0.0);
    for error in errors.filter(|error| error.is_finite()) {
        known += 1.0;
        off += f64::from(u8::from(error > MAX_ERROR_M));
        off_base += f64::from(u8::from(error > MAX_BASE_ERROR_M));
    }
    (known > 0.0).then(|| [off / known, off_base / known])
}
