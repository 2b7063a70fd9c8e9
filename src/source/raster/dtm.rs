//! The bare-earth terrain: one or many georeferenced rasters, sampled as one surface.
//!
//! Ground = bilinear between pixel centres of the file as it was surveyed. GDAL's own warper is not used
//! for this: beside missing pixels it renormalises the weights, which is no longer that surface.

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::height_steps::find_step;
use super::mosaic_source::MosaicSource;
use super::sampler::MosaicSampler;
use super::smoothing::Smoothing;
use crate::source::{CrsChoice, SourceError, SourceRole};
use crate::space::{Bounds, Crs, GeoArea};

/// Terrain rasters, finest pixels first; where several cover a point the first that knows it counts.
#[derive(Clone, Debug)]
pub struct Dtm {
    sources: Vec<MosaicSource>,
}

/// Where a source's own samples lie in the city's CRS: north up, square, or rectangular with one side a multiple of the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleLattice {
    /// Centre of a pixel.
    pub anchor: DVec2,
    /// Distance between samples, metres: the source's own, or the round number that it is to its rounding.
    pub step_m: f64,
}

/// Files whose heights are stored in whole steps that show as terraces.
#[derive(Clone, Debug, PartialEq)]
pub struct SteppedHeights {
    /// The first of the files.
    pub path: PathBuf,
    /// How many there are.
    pub files: usize,
    /// The step, metres.
    pub step_m: f64,
    /// Side of a pixel, metres.
    pub pixel_m: f64,
}

impl Dtm {
    /// Opens the files' headers. `choice` decides their CRS; `metres_per_unit` overrides
    /// the vertical unit.
    pub fn open(
        files: &[PathBuf],
        choice: &CrsChoice,
        metres_per_unit: Option<f64>,
    ) -> Result<Self, SourceError> {
        let mut sources: Vec<MosaicSource> = Vec::new();
        for file in files {
            let mosaic = MosaicSource::open(file, choice, metres_per_unit)?;
            match sources.iter_mut().find(|other| other.shares_lattice(&mosaic)) {
                Some(other) => other.join(mosaic)?,
                None => sources.push(mosaic),
            }
        }
        sources.sort_by(|a, b| a.pixel_m.total_cmp(&b.pixel_m));
        Ok(Self { sources })
    }

    /// The CRS of the finest file.
    pub fn crs(&self) -> &Crs {
        &self.sources[0].crs
    }

    /// The CRS of every mosaic source, finest first.
    pub fn all_crs(&self) -> impl Iterator<Item = &Crs> {
        self.sources.iter().map(|mosaic| &mosaic.crs)
    }

    /// Side of the finest pixel, metres.
    pub fn finest_pixel_m(&self) -> f64 {
        self.sources[0].pixel_m
    }

    /// The first of the files with the finest pixels, their rectangle in the city's CRS, and the side of a pixel, metres.
    pub fn finest_file(&self, city: &Crs) -> Result<(&Path, Bounds, f64), SourceError> {
        let mosaic = &self.sources[0];
        Ok((&mosaic.files[0].path, mosaic.bounds_in(city)?, mosaic.pixel_m))
    }

    /// Side of the coarsest pixel, metres.
    pub fn coarsest_pixel_m(&self) -> f64 {
        self.sources.last().map_or(0.0, |mosaic| mosaic.pixel_m)
    }

    /// Looks for heights stored in whole steps at so fine a spacing that they show as terraces, and from then on smooths
    /// them within half a step unless they are to be kept. Reads a few blocks of each file.
    pub fn find_stepped_heights(&mut self, keep: bool) -> Result<Vec<SteppedHeights>, SourceError> {
        let mut found = Vec::new();
        for mosaic in &mut self.sources {
            let Some(step_m) = find_step(mosaic)? else {
                continue;
            };
            mosaic.smoothing = (!keep).then(|| Smoothing::new(step_m, mosaic.pixel_m));
            found.push(SteppedHeights {
                path: mosaic.files[0].path.clone(),
                files: mosaic.files.len(),
                step_m,
                pixel_m: mosaic.pixel_m,
            });
        }
        Ok(found)
    }

    /// Where the samples lie of the finest source that meets `bounds`, when it is in the city's CRS, north up: then the
    /// city's samples can be the source's own.
    pub fn lattice_in(&self, city: &Crs, bounds: &Bounds) -> Result<Option<SampleLattice>, SourceError> {
        for mosaic in &self.sources {
            if mosaic.bounds_in(city)?.meets(bounds) {
                return Ok(mosaic.lattice_in(city));
            }
        }
        Ok(None)
    }

    /// The rectangle of all pixels in the city's CRS, metres.
    pub fn bounds_in(&self, city: &Crs) -> Result<Bounds, SourceError> {
        let mut bounds = Bounds::EMPTY;
        for mosaic in &self.sources {
            bounds = bounds.union(&mosaic.bounds_in(city)?);
        }
        Ok(bounds)
    }

    /// Files none of whose pixels lie in a rectangle of the city.
    pub fn files_outside(&self, city: &Crs, bounds: &Bounds) -> Result<Vec<&Path>, SourceError> {
        let mut outside = Vec::new();
        for mosaic in &self.sources {
            for file in &mosaic.files {
                if !mosaic.part_in(city, file.first, file.size)?.meets(bounds) {
                    outside.push(file.path.as_path());
                }
            }
        }
        Ok(outside)
    }

    /// Files in a CRS not in metres that say nothing of their vertical unit: their heights are taken as metres.
    pub fn files_of_unspecified_unit(&self) -> impl Iterator<Item = &Path> {
        let files = self.sources.iter().flat_map(|mosaic| &mosaic.files);
        files
            .filter(|file| file.unit_unspecified)
            .map(|file| file.path.as_path())
    }

    /// Where on the globe the finest mosaic source lies.
    pub fn area_on_globe(&self) -> Result<GeoArea, SourceError> {
        let mosaic = &self.sources[0];
        let (west, south) = (mosaic.bounds.west, mosaic.bounds.south);
        let (east, north) = (mosaic.bounds.east, mosaic.bounds.north);
        mosaic
            .crs
            .area_on_globe(DVec2::new(west, south), DVec2::new(east, north))
            .map_err(|source| mosaic.crs_error(source))?
            .ok_or_else(|| SourceError::WrongCrs {
                path: mosaic.files[0].path.clone(),
                role: SourceRole::Terrain,
                why: "lies outside the area of its own coordinate reference system".to_owned(),
            })
    }

    /// Opens the files for reading; one sampler per thread.
    pub fn sampler(&self, city: &Crs) -> Result<DtmSampler, SourceError> {
        let sources = self
            .sources
            .iter()
            .map(|mosaic| MosaicSampler::open(mosaic, city))
            .collect::<Result<_, _>>()?;
        Ok(DtmSampler { sources })
    }
}

/// The terrain opened for reading by one thread.
pub struct DtmSampler {
    sources: Vec<MosaicSampler>,
}

impl DtmSampler {
    /// Heights on a lattice in the city's CRS: sample (i, j), counted from `first`, lies at
    /// `origin + (i, j) * step`, j to the north. Indices count from the grid's corner, not the tile's, so that
    /// tiles which share a border compute the same points bit for bit. Returns `size[0] * size[1]` metres, row by row from the south, NaN without ground.
    pub fn lattice(
        &mut self,
        origin: DVec2,
        step: f64,
        first: [i64; 2],
        size: [usize; 2],
    ) -> Result<Vec<f32>, SourceError> {
        let mut heights = vec![f32::NAN; size[0] * size[1]];
        for mosaic in &mut self.sources {
            if heights.iter().all(|height| !height.is_nan()) {
                break;
            }
            mosaic.fill_lattice(origin, step, first, size, &mut heights)?;
        }
        Ok(heights)
    }
}
