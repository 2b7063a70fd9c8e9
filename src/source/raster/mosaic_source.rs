//! Terrain files of one CRS whose pixels lie on one lattice, read as one mosaic: headers only.

use std::path::{Path, PathBuf};

use gdal::{Dataset, GeoTransformEx};
use glam::DVec2;

use super::dtm::SampleLattice;
use super::smoothing::Smoothing;
use super::whole_raster::require_all_samples;
use crate::source::{CrsChoice, SourceError, SourceRole, gdal_says, require_sound};
use crate::space::{Bounds, Crs, PointTransform};

/// A sample so near a pixel's centre, in pixels, is that pixel.
pub const SNAP_PIXELS: f64 = 1e-3;

/// A file with its place in the mosaic source, pixels from the mosaic source's north-west corner.
#[derive(Clone, Debug)]
pub struct MosaicFile {
    pub path: PathBuf,
    pub first: [usize; 2],
    pub size: [usize; 2],
    /// The CRS is not in metres, and neither file nor user names the unit of heights.
    pub unit_unspecified: bool,
}

/// Files of one CRS whose pixels lie on one lattice, read as one mosaic; later files lie on top.
#[derive(Clone, Debug)]
pub struct MosaicSource {
    pub files: Vec<MosaicFile>,
    pub crs: Crs,
    pub pixel_from_ground: [f64; 6],
    pub ground_from_pixel: [f64; 6],
    pub size: [usize; 2],
    pub metres_per_unit: f64,
    pub pixel_m: f64,
    pub bounds: Bounds,
    /// How its heights are smoothed, when they are.
    pub smoothing: Option<Smoothing>,
}

/// Finest pixels of rasters that do not lie north up, and of any, metres; and the coarsest.
const MIN_ROTATED_M: f64 = 0.1;
const MIN_PIXEL_M: f64 = 1e-4;
const MAX_PIXEL_M: f64 = 1e6;

impl MosaicSource {
    pub fn open(path: &Path, choice: &CrsChoice, metres_per_unit: Option<f64>) -> Result<Self, SourceError> {
        require_sound(path)?;
        let dataset = open_raster(path)?;
        require_all_samples(path, &dataset)?;
        let unfit = |what: &str, advice: &str| SourceError::Unfit {
            path: path.to_owned(),
            what: what.to_owned(),
            advice: advice.to_owned(),
        };
        let (width, height) = dataset.raster_size();
        if dataset.raster_count() == 0 || width < 2 || height < 2 {
            return Err(unfit(
                "holds no raster of at least 2 x 2 pixels",
                "give a terrain raster",
            ));
        }
        let band = dataset.rasterband(1).map_err(|error| SourceError::Read {
            path: path.to_owned(),
            why: gdal_says(&error),
        })?;
        if dataset.raster_count() >= 3 && band.band_type() == gdal::raster::GdalDataType::UInt8 {
            return Err(SourceError::NotTerrain {
                path: path.to_owned(),
            });
        }
        let ground_from_pixel = dataset.geo_transform().map_err(|_| {
            unfit(
                "has no georeference",
                "add a world file or assign one with gdal_edit.py -a_ullr",
            )
        })?;
        let pixel_from_ground = ground_from_pixel
            .invert()
            .map_err(|_| unfit("has a georeference of zero area", "mend it with gdal_edit.py"))?;
        let crs = choice.of_file(path, dataset.spatial_ref().ok(), SourceRole::Terrain)?;
        let unit = metres_per_unit
            .or_else(|| metres_of_unit(&band.unit()))
            .or(crs.metres_per_height_unit());
        let mut mosaic = Self {
            files: vec![MosaicFile {
                path: path.to_owned(),
                first: [0, 0],
                size: [width, height],
                unit_unspecified: unit.is_none() && crs.has_non_metric_lengths(),
            }],
            crs,
            pixel_from_ground,
            ground_from_pixel,
            size: [width, height],
            metres_per_unit: unit.unwrap_or(1.0),
            pixel_m: 0.0,
            bounds: Bounds::EMPTY,
            smoothing: None,
        };
        mosaic.measure();
        let [_, _, skew_x, _, skew_y, _] = ground_from_pixel;
        // More than rounding: over the whole raster it makes a pixel.
        let [_, pixel_x, _, _, _, pixel_y] = ground_from_pixel;
        let is_rotated =
            skew_x.abs() * height as f64 > pixel_x.abs() || skew_y.abs() * width as f64 > pixel_y.abs();
        if is_rotated && mosaic.pixel_m < MIN_ROTATED_M {
            return Err(unfit(
                "has very fine pixels that do not lie north up: every tile would be read through all of it",
                "lay it north up and coarser first, with gdalwarp -tr 0.5 0.5",
            ));
        }
        if !(MIN_PIXEL_M..MAX_PIXEL_M).contains(&mosaic.pixel_m) {
            return Err(unfit(
                "has pixels of no believable size",
                "check its georeference and CRS with gdalinfo",
            ));
        }
        Ok(mosaic)
    }

    pub fn crs_error(&self, source: crate::space::CrsError) -> SourceError {
        SourceError::Crs {
            path: self.files[0].path.clone(),
            source,
        }
    }

    /// The rectangle of the pixels, and the side of a pixel in metres at the centre.
    fn measure(&mut self) {
        let [width, height] = self.size.map(|count| count as f64);
        self.bounds = Bounds::EMPTY;
        for (column, row) in [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)] {
            let (x, y) = self.ground_from_pixel.apply(column, row);
            self.bounds.include(x, y);
        }
        let (x0, y0) = self.ground_from_pixel.apply(0.5 * width, 0.5 * height);
        let (x1, y1) = self.ground_from_pixel.apply(0.5 * width + 1.0, 0.5 * height);
        let (x2, y2) = self.ground_from_pixel.apply(0.5 * width, 0.5 * height + 1.0);
        let scale = self.crs.metres_per_unit_at(DVec2::new(x0, y0));
        let side = |x: f64, y: f64| (DVec2::new(x - x0, y - y0) * scale).length();
        self.pixel_m = side(x1, y1).min(side(x2, y2));
    }

    /// Where the pixel centres lie, when that is a lattice of the city.
    pub fn lattice_in(&self, city: &Crs) -> Option<SampleLattice> {
        let [x0, dx, rx, y0, ry, dy] = self.ground_from_pixel;
        if [rx, ry] != [0.0; 2] || !self.crs.same_as(city) {
            return None;
        }
        let (width, height) = (dx.abs(), dy.abs());
        let step = width.min(height);
        let ratio = width.max(height) / step;
        // Whole up to the rounding of decimals: off by less than a hundredth of a pixel over the whole raster.
        let pixels = self.size[0].max(self.size[1]) as f64;
        let whole = (ratio - ratio.round()).abs() * pixels < 0.01 && ratio < 16.5;
        let rounded = (step * 1000.0).round() / 1000.0;
        let is_rounded =
            (rounded / step - 1.0).abs() * pixels < SNAP_PIXELS && (rounded / step - 1.0).abs() < 1e-7;
        let micrometres = |value: f64| (value * 1e6).round() / 1e6;
        whole.then(|| SampleLattice {
            anchor: DVec2::new(micrometres(x0 + 0.5 * dx), micrometres(y0 + 0.5 * dy)),
            step_m: if is_rounded { rounded } else { step },
        })
    }

    pub fn shares_lattice(&self, other: &Self) -> bool {
        let [ax, adx, arx, ay, ary, ady] = self.ground_from_pixel;
        let [bx, bdx, brx, by, bry, bdy] = other.ground_from_pixel;
        let same_step = adx == bdx && ady == bdy && [arx, ary, brx, bry] == [0.0; 4];
        let off = |a: f64, b: f64, step: f64| {
            let pixels = (b - a) / step;
            (pixels - pixels.round()).abs()
        };
        same_step
            && self.metres_per_unit == other.metres_per_unit
            && off(ax, bx, adx) < 1e-3
            && off(ay, by, ady) < 1e-3
            && self.crs.same_as(&other.crs)
    }

    pub fn join(&mut self, other: Self) -> Result<(), SourceError> {
        let [ax, adx, _, ay, _, ady] = self.ground_from_pixel;
        let (bx, by) = (other.ground_from_pixel[0], other.ground_from_pixel[3]);
        let shift = [((bx - ax) / adx).round() as i64, ((by - ay) / ady).round() as i64];
        // The mosaic source grows to hold both; every file keeps its place in it.
        let grow = shift.map(|pixels| (-pixels).max(0));
        for file in &mut self.files {
            file.first = [0, 1].map(|axis| file.first[axis] + grow[axis] as usize);
        }
        for mut file in other.files {
            file.first = [0, 1].map(|axis| file.first[axis] + (shift[axis] + grow[axis]) as usize);
            self.files.push(file);
        }
        self.size = [0, 1].map(|axis| {
            let ends = self.files.iter().map(|file| file.first[axis] + file.size[axis]);
            ends.max().unwrap_or(0)
        });
        self.ground_from_pixel[0] = ax - grow[0] as f64 * adx;
        self.ground_from_pixel[3] = ay - grow[1] as f64 * ady;
        self.pixel_from_ground = self.ground_from_pixel.invert().map_err(|e| self.read_error(&e))?;
        self.measure();
        Ok(())
    }

    fn read_error(&self, error: &gdal::errors::GdalError) -> SourceError {
        SourceError::Read {
            path: self.files[0].path.clone(),
            why: gdal_says(error),
        }
    }

    /// The rectangle of all pixels in the city's CRS, metres.
    pub fn bounds_in(&self, city: &Crs) -> Result<Bounds, SourceError> {
        self.part_in(city, [0, 0], self.size)
    }

    /// The rectangle of some of its pixels in the city's CRS, metres.
    pub fn part_in(&self, city: &Crs, first: [usize; 2], size: [usize; 2]) -> Result<Bounds, SourceError> {
        let transform = PointTransform::new(&self.crs, city).map_err(|s| self.crs_error(s))?;
        let mut bounds = Bounds::EMPTY;
        const STEPS: usize = 32;
        let [west, north] = first.map(|count| count as f64);
        let [width, height] = size.map(|count| count as f64);
        for side in 0..4 {
            for step in 0..=STEPS {
                let along = step as f64 / STEPS as f64;
                let (u, v) = [(along, 0.0), (along, 1.0), (0.0, along), (1.0, along)][side];
                let (x, y) = self.ground_from_pixel.apply(west + u * width, north + v * height);
                if let Some(point) = transform.point(DVec2::new(x, y)) {
                    bounds.include(point.x, point.y);
                }
            }
        }
        Ok(bounds)
    }
}

pub fn open_raster(path: &Path) -> Result<Dataset, SourceError> {
    Dataset::open_ex(
        path,
        gdal::DatasetOptions {
            open_flags: gdal::GdalOpenFlags::GDAL_OF_RASTER
                | gdal::GdalOpenFlags::GDAL_OF_READONLY
                | gdal::GdalOpenFlags::GDAL_OF_VERBOSE_ERROR,
            ..Default::default()
        },
    )
    .map_err(|error| SourceError::Open {
        path: path.to_owned(),
        why: gdal_says(&error),
        expected: "raster",
    })
}

fn metres_of_unit(unit: &str) -> Option<f64> {
    match unit.trim().to_lowercase().as_str() {
        "m" | "metre" | "meter" | "metres" | "meters" => Some(1.0),
        "ft" | "foot" | "feet" | "international foot" => Some(0.3048),
        "us-ft" | "ftus" | "us survey foot" | "us survey feet" | "foot_us" => Some(1200.0 / 3937.0),
        "cm" | "centimetre" | "centimeter" => Some(0.01),
        "dm" => Some(0.1),
        _ => None,
    }
}
