//! The tile grid and the terrain's lattice of a city to be made.

use super::sources::Sources;
use super::spacing::Spacing;
use super::{ImportOptions, TILE_TEXELS};
use crate::city::CityError;
use crate::city::manifest::{MAX_IMAGERY_SIDE, MAX_TILES};
use crate::source::{Footprint, FootprintReport, ImageryMosaic};
use crate::space::{Bounds, TileGrid};

/// The tile grid and the terrain's lattice.
pub struct Plan {
    /// Tiles.
    pub grid: TileGrid,
    /// Samples along a tile's side.
    pub terrain_side: usize,
    /// Distance between samples, metres.
    pub terrain_step_m: f64,
    /// What heights are rounded to, metres: interpolated ones need not be stored to the last bit.
    pub rounding_m: Option<f32>,
    /// Longest run of missing samples that is filled.
    pub fill_samples: usize,
    /// Widest hole that is filled, metres, where a wider one was asked for.
    pub fill_cut_m: Option<f64>,
}

/// Longest run of missing samples that is filled, whatever is asked: a tile's neighbourhood of it fits in memory.
const MAX_FILL_SAMPLES: usize = 1024;

/// How far the tiles reach beyond the terrain for a footprint that does, metres; one that reaches farther is cut at its edge.
const MAX_OVERHANG_M: f64 = 250.0;

impl Plan {
    /// Tiles that cover the built-up part of the terrain and its surroundings.
    pub fn new(
        sources: &Sources,
        options: &ImportOptions,
        footprints: &[Footprint],
        report: &FootprintReport,
    ) -> Result<Self, CityError> {
        let terrain = sources.dtm.bounds_in(&sources.crs)?;
        let (mut built, mut all, mut whole) = (Bounds::EMPTY, Bounds::EMPTY, Bounds::EMPTY);
        let around = terrain.grown(MAX_OVERHANG_M);
        for footprint in footprints {
            let bounds = outline_bounds(footprint);
            all = all.union(&bounds);
            if bounds.meets(&terrain) {
                built = built.union(&bounds);
                if bounds.intersection(&around) == bounds {
                    whole = whole.union(&bounds);
                }
            }
        }
        if report.read == 0 {
            return Err(CityError::EmptyLayer {
                path: options.buildings.clone(),
            });
        }
        // What stands over the terrain's edge is not cut.
        let bounds = built.grown(options.margin_m).intersection(&terrain).union(&whole);
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
        if tiles > MAX_TILES as f64 {
            return Err(CityError::TooManyTiles {
                tiles,
                extent: describe(&bounds),
            });
        }
        require_useful_pixels(sources, &bounds, tile_m)?;
        let lattice = sources.dtm.lattice_in(&sources.crs, &bounds)?;
        let spacing = match &lattice {
            Some(lattice) => Spacing::on_samples(&bounds, tile_m, lattice),
            None => Spacing::measured(&bounds, options.texel_m, &sources.dtm, &sources.crs)?,
        };
        // A hole of w metres is w wide between its known edges: pixels where they are the samples, and elsewhere up to a
        // pixel more, because bilinear needs both neighbours.
        let hole_m = match lattice {
            Some(lattice) if options.fill_m < lattice.step_m => 0.0,
            Some(lattice) => {
                let parts_m = (lattice.step_m - spacing.step_m).max(0.0);
                (options.fill_m / lattice.step_m).floor() * lattice.step_m + parts_m
            }
            None if options.fill_m > 0.0 => options.fill_m + sources.dtm.coarsest_pixel_m(),
            None => 0.0,
        };
        let hole_samples = (hole_m / spacing.step_m + 1e-6) as usize;
        Ok(Self {
            grid: spacing.grid,
            terrain_side: spacing.intervals + 1,
            terrain_step_m: spacing.step_m,
            rounding_m: lattice.is_none().then(|| rounding(spacing.step_m)),
            fill_samples: hole_samples.min(MAX_FILL_SAMPLES),
            fill_cut_m: (hole_samples > MAX_FILL_SAMPLES).then_some(MAX_FILL_SAMPLES as f64 * spacing.step_m),
        })
    }
}

/// Pixels that are read of a source at most where those stored of it, 1024 along a tile's side, are so many times fewer.
const MAX_PIXELS: f64 = 2e9;
const PIXELS_A_SAMPLE: f64 = 450.0;

/// Refuses a source so much finer than the city that reading it would be hours of work for nothing.
fn require_useful_pixels(sources: &Sources, bounds: &Bounds, tile_m: f64) -> Result<(), CityError> {
    let finest_m = tile_m / MAX_IMAGERY_SIDE as f64;
    let terrain = sources.dtm.finest_file(&sources.crs)?;
    let imagery = sources.imagery.iter().flat_map(ImageryMosaic::file_sizes);
    for (path, extent, pixel_m) in [terrain].into_iter().chain(imagery) {
        let part = extent.intersection(bounds);
        let a_sample = (finest_m / pixel_m).powi(2);
        if part.is_empty() || a_sample <= PIXELS_A_SAMPLE {
            continue;
        }
        let pixels = part.width() * part.height() / (pixel_m * pixel_m);
        if pixels > MAX_PIXELS {
            return Err(CityError::TooFine {
                path: path.to_owned(),
                pixels,
                times: a_sample.sqrt(),
            });
        }
    }
    Ok(())
}

/// A power of two that changes slopes by less than 0.2 %: 8 mm for samples 4 m apart. Zeros in the last bits halve the files.
fn rounding(step_m: f64) -> f32 {
    (step_m / 512.0).log2().floor().exp2() as f32
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
        .map(|(why, count)| format!(", {count} rejected: {why}"))
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
