//! The bare-earth terrain: one or many georeferenced rasters, sampled as one surface.
//!
//! Ground = bilinear between pixel centres of the file as it was surveyed. GDAL's own warper is not used
//! for this: beside missing pixels it renormalises the weights, which is no longer that surface.

use std::path::{Path, PathBuf};

use gdal::raster::ResampleAlg;
use gdal::{Dataset, GeoTransformEx};
use glam::DVec2;

use super::window::Window;
use crate::source::{CrsChoice, SourceError};
use crate::space::{Bounds, Crs, PointTransform};

/// Terrain rasters, finest pixels first; where several cover a point the first that knows it counts.
#[derive(Clone, Debug)]
pub struct Dtm {
    sheets: Vec<Sheet>,
}

/// A file with its place in the sheet, pixels from the sheet's north-west corner.
#[derive(Clone, Debug)]
struct SheetFile {
    path: PathBuf,
    first: [usize; 2],
    size: [usize; 2],
}

/// Files of one CRS whose pixels lie on one lattice, read as one mosaic; later files lie on top.
#[derive(Clone, Debug)]
struct Sheet {
    files: Vec<SheetFile>,
    crs: Crs,
    pixel_from_ground: [f64; 6],
    ground_from_pixel: [f64; 6],
    size: [usize; 2],
    metres_per_unit: f64,
    pixel_m: f64,
    bounds: Bounds,
}

/// Lowest and highest believable ground, metres; beyond lie sentinels such as -32768 and 3.4e38.
const BELIEVABLE_M: std::ops::Range<f64> = -12_000.0..9_000.0;

/// What many writers put for missing ground without declaring it.
const UNDECLARED_NO_DATA: f64 = -9999.0;

/// Most pixels read at a time for one tile (64 MiB of f32).
const MOST_PIXELS: usize = 1 << 24;

/// Samples between two points where the transformation to the file's CRS is computed exactly.
const TRANSFORM_STEP: usize = 16;

impl Dtm {
    /// Opens the files' headers. `choice` decides their CRS; `metres_per_unit` overrides
    /// the vertical unit.
    pub fn open(
        files: &[PathBuf],
        choice: &CrsChoice,
        metres_per_unit: Option<f64>,
    ) -> Result<Self, SourceError> {
        let mut sheets: Vec<Sheet> = Vec::new();
        for file in files {
            let sheet = Sheet::open(file, choice, metres_per_unit)?;
            match sheets.iter_mut().find(|other| other.shares_lattice(&sheet)) {
                Some(other) => other.join(sheet)?,
                None => sheets.push(sheet),
            }
        }
        sheets.sort_by(|a, b| a.pixel_m.total_cmp(&b.pixel_m));
        Ok(Self { sheets })
    }

    /// The CRS of the finest file.
    pub fn crs(&self) -> &Crs {
        &self.sheets[0].crs
    }

    /// Side of the finest pixel, metres.
    pub fn finest_pixel_m(&self) -> f64 {
        self.sheets[0].pixel_m
    }

    /// Side of the coarsest pixel, metres.
    pub fn coarsest_pixel_m(&self) -> f64 {
        self.sheets.last().map_or(0.0, |sheet| sheet.pixel_m)
    }

    /// A pixel centre and the pixel's side, when all files share one lattice in the city's CRS, north up
    /// with square pixels: then the city's samples can be the file's own.
    pub fn lattice_in(&self, city: &Crs) -> Option<(DVec2, f64)> {
        let [sheet] = self.sheets.as_slice() else {
            return None;
        };
        let [x0, dx, rx, y0, ry, dy] = sheet.ground_from_pixel;
        let square = rx == 0.0 && ry == 0.0 && dx > 0.0 && (dx + dy).abs() < 1e-9 * dx;
        (square && sheet.crs.same_as(city)).then(|| (DVec2::new(x0 + 0.5 * dx, y0 + 0.5 * dy), dx))
    }

    /// The rectangle of all pixels in the city's CRS, metres.
    pub fn bounds_in(&self, city: &Crs) -> Result<Bounds, SourceError> {
        let mut bounds = Bounds::EMPTY;
        for sheet in &self.sheets {
            bounds = bounds.union(&sheet.bounds_in(city)?);
        }
        Ok(bounds)
    }

    /// Longitude and latitude of the finest sheet's middle, degrees.
    pub fn centre_on_globe(&self) -> Result<DVec2, SourceError> {
        let sheet = &self.sheets[0];
        let crs_error = |source| sheet.crs_error(source);
        let globe = Crs::from_text("EPSG:4326").map_err(crs_error)?;
        PointTransform::new(&sheet.crs, &globe)
            .map_err(crs_error)?
            .point(sheet.bounds.centre())
            .ok_or_else(|| SourceError::Unfit {
                path: sheet.files[0].path.clone(),
                what: "lies outside the area of its own coordinate reference system".to_owned(),
                advice: "check its georeference, or name the right CRS with --terrain-crs EPSG:n".to_owned(),
            })
    }

    /// Opens the files for reading; one sampler per thread.
    pub fn sampler(&self, city: &Crs) -> Result<DtmSampler, SourceError> {
        let sheets = self
            .sheets
            .iter()
            .map(|sheet| SheetSampler::open(sheet, city))
            .collect::<Result<_, _>>()?;
        Ok(DtmSampler { sheets })
    }
}

/// The terrain opened for reading by one thread.
pub struct DtmSampler {
    sheets: Vec<SheetSampler>,
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
        for sheet in &mut self.sheets {
            if heights.iter().all(|height| !height.is_nan()) {
                break;
            }
            sheet.fill_lattice(origin, step, first, size, &mut heights)?;
        }
        Ok(heights)
    }
}

impl Sheet {
    fn open(path: &Path, choice: &CrsChoice, metres_per_unit: Option<f64>) -> Result<Self, SourceError> {
        let dataset = open_raster(path)?;
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
            why: error.to_string(),
        })?;
        if dataset.raster_count() >= 3 && band.band_type() == gdal::raster::GdalDataType::UInt8 {
            return Err(unfit(
                "looks like a photo (three or more 8-bit bands), not like terrain",
                "give it with --photo",
            ));
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
        let crs = choice.of_file(path, dataset.spatial_ref().ok(), "--terrain-crs")?;
        let unit = metres_per_unit
            .or_else(|| metres_of_unit(&band.unit()))
            .or(crs.metres_per_height_unit())
            .unwrap_or(1.0);
        let mut sheet = Self {
            files: vec![SheetFile {
                path: path.to_owned(),
                first: [0, 0],
                size: [width, height],
            }],
            crs,
            pixel_from_ground,
            ground_from_pixel,
            size: [width, height],
            metres_per_unit: unit,
            pixel_m: 0.0,
            bounds: Bounds::EMPTY,
        };
        sheet.measure()?;
        Ok(sheet)
    }

    fn crs_error(&self, source: crate::space::CrsError) -> SourceError {
        SourceError::Crs {
            path: self.files[0].path.clone(),
            source,
        }
    }

    /// The rectangle of the pixels, and the side of a pixel in metres at the middle.
    fn measure(&mut self) -> Result<(), SourceError> {
        let [width, height] = self.size.map(|count| count as f64);
        self.bounds = Bounds::EMPTY;
        for (column, row) in [(0.0, 0.0), (width, height)] {
            let (x, y) = self.ground_from_pixel.apply(column, row);
            self.bounds.include(x, y);
        }
        let (x0, y0) = self.ground_from_pixel.apply(0.5 * width, 0.5 * height);
        let (x1, y1) = self.ground_from_pixel.apply(0.5 * width + 1.0, 0.5 * height);
        let (x2, y2) = self.ground_from_pixel.apply(0.5 * width, 0.5 * height + 1.0);
        let reference = self.crs.reference().map_err(|s| self.crs_error(s))?;
        let scale = if reference.is_geographic() {
            let metres = reference.semi_major().unwrap_or(6_378_137.0) * reference.angular_units();
            DVec2::new(metres * (y0 * reference.angular_units()).cos(), metres)
        } else {
            DVec2::splat(reference.linear_units())
        };
        let side = |x: f64, y: f64| (DVec2::new(x - x0, y - y0) * scale).length();
        self.pixel_m = side(x1, y1).min(side(x2, y2));
        Ok(())
    }

    fn shares_lattice(&self, other: &Self) -> bool {
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

    fn join(&mut self, other: Self) -> Result<(), SourceError> {
        let [ax, adx, _, ay, _, ady] = self.ground_from_pixel;
        let (bx, by) = (other.ground_from_pixel[0], other.ground_from_pixel[3]);
        let shift = [((bx - ax) / adx).round() as i64, ((by - ay) / ady).round() as i64];
        // The sheet grows to hold both; every file keeps its place in it.
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
        self.measure()
    }

    fn read_error(&self, error: &gdal::errors::GdalError) -> SourceError {
        SourceError::Read {
            path: self.files[0].path.clone(),
            why: error.to_string(),
        }
    }

    fn bounds_in(&self, city: &Crs) -> Result<Bounds, SourceError> {
        let transform = PointTransform::new(&self.crs, city).map_err(|s| self.crs_error(s))?;
        let mut bounds = Bounds::EMPTY;
        const STEPS: usize = 32;
        let [width, height] = self.size.map(|count| count as f64);
        for side in 0..4 {
            for step in 0..=STEPS {
                let along = step as f64 / STEPS as f64;
                let (u, v) = [(along, 0.0), (along, 1.0), (0.0, along), (1.0, along)][side];
                let (x, y) = self.ground_from_pixel.apply(u * width, v * height);
                if let Some(point) = transform.point(DVec2::new(x, y)) {
                    bounds.include(point.x, point.y);
                }
            }
        }
        Ok(bounds)
    }
}

/// One sheet opened, with the way from the city's CRS to its pixels.
struct SheetSampler {
    sheet: Sheet,
    files: Vec<OpenFile>,
    file_from_city: PointTransform,
}

/// One file of a sheet.
struct OpenFile {
    dataset: Dataset,
    place: SheetFile,
    no_data: Option<f64>,
    scale: f64,
    offset: f64,
}

impl SheetSampler {
    fn open(sheet: &Sheet, city: &Crs) -> Result<Self, SourceError> {
        let files = sheet
            .files
            .iter()
            .map(|place| {
                let dataset = open_raster(&place.path)?;
                let band = dataset.rasterband(1).map_err(|e| damaged(&place.path, &e))?;
                Ok(OpenFile {
                    no_data: band.no_data_value(),
                    scale: band.scale().unwrap_or(1.0) * sheet.metres_per_unit,
                    offset: band.offset().unwrap_or(0.0) * sheet.metres_per_unit,
                    place: place.clone(),
                    dataset,
                })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            file_from_city: PointTransform::new(city, &sheet.crs)
                .map_err(|source| sheet.crs_error(source))?,
            sheet: sheet.clone(),
            files,
        })
    }

    fn fill_lattice(
        &mut self,
        origin: DVec2,
        step: f64,
        first: [i64; 2],
        size: [usize; 2],
        heights: &mut [f32],
    ) -> Result<(), SourceError> {
        let pixels = self.pixel_coordinates(origin, step, first, size);
        let Some((low, high)) = self.window_of(&pixels) else {
            return Ok(());
        };
        // A tile of a very fine raster is read in bands of rows that fit in memory.
        let window_pixels = (high[0] - low[0]) * (high[1] - low[1]);
        if window_pixels > MOST_PIXELS && size[1] > 1 {
            let half = size[1] / 2;
            let (south, north) = heights.split_at_mut(half * size[0]);
            self.fill_lattice(origin, step, first, [size[0], half], south)?;
            return self.fill_lattice(
                origin,
                step,
                [first[0], first[1] + half as i64],
                [size[0], size[1] - half],
                north,
            );
        }
        let window = self.read(low, high)?;
        for (height, pixel) in heights.iter_mut().zip(&pixels) {
            if height.is_nan() {
                *height = window.bilinear(pixel.x, pixel.y) as f32;
            }
        }
        Ok(())
    }

    /// Pixel coordinates of every lattice sample. The transformation is exact on every 16th sample counted
    /// from the grid's corner and linear between (off by L²/8R, 0.1 mm for 64 m), so that it depends on the
    /// place alone and neighbours agree on their common border.
    fn pixel_coordinates(&self, origin: DVec2, step: f64, first: [i64; 2], size: [usize; 2]) -> Vec<DVec2> {
        let to_pixel = |point: DVec2| {
            let (column, row) = self.sheet.pixel_from_ground.apply(point.x, point.y);
            DVec2::new(column, row)
        };
        if self.file_from_city.is_identity() {
            return (0..size[0] * size[1])
                .map(|k| {
                    let (i, j) = (first[0] + (k % size[0]) as i64, first[1] + (k / size[0]) as i64);
                    to_pixel(origin + DVec2::new(i as f64, j as f64) * step)
                })
                .collect();
        }
        let stride = TRANSFORM_STEP as i64;
        let node_first = first.map(|index| index.div_euclid(stride) * stride);
        let nodes = [0, 1].map(|axis| {
            let span = first[axis] + size[axis] as i64 - 1 - node_first[axis];
            (span.div_euclid(stride) + 2) as usize
        });
        let (mut xs, mut ys) = (Vec::new(), Vec::new());
        for k in 0..nodes[0] * nodes[1] {
            let i = node_first[0] + (k % nodes[0]) as i64 * stride;
            let j = node_first[1] + (k / nodes[0]) as i64 * stride;
            xs.push(origin.x + i as f64 * step);
            ys.push(origin.y + j as f64 * step);
        }
        self.file_from_city.points(&mut xs, &mut ys);
        let node_pixels: Vec<DVec2> = xs
            .iter()
            .zip(&ys)
            .map(|(x, y)| to_pixel(DVec2::new(*x, *y)))
            .collect();
        (0..size[0] * size[1])
            .map(|k| {
                let split = |index: usize, axis: usize| {
                    let along =
                        (first[axis] + index as i64 - node_first[axis]) as f64 / TRANSFORM_STEP as f64;
                    (along.floor() as usize, along.fract())
                };
                let (i, fx) = split(k % size[0], 0);
                let (j, fy) = split(k / size[0], 1);
                let node = |i: usize, j: usize| node_pixels[j * nodes[0] + i];
                let south = node(i, j).lerp(node(i + 1, j), fx);
                let north = node(i, j + 1).lerp(node(i + 1, j + 1), fx);
                south.lerp(north, fy)
            })
            .collect()
    }

    /// The block of pixels that bilinear sampling at `pixels` touches, cut to the raster.
    fn window_of(&self, pixels: &[DVec2]) -> Option<([usize; 2], [usize; 2])> {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for pixel in pixels.iter().filter(|pixel| pixel.is_finite()) {
            low = low.min(*pixel);
            high = high.max(*pixel);
        }
        let [width, height] = self.sheet.size;
        let clamp = |value: f64, count: usize| value.clamp(0.0, count as f64) as usize;
        let first = [clamp(low.x - 1.5, width), clamp(low.y - 1.5, height)];
        let last = [clamp(high.x + 2.5, width), clamp(high.y + 2.5, height)];
        (low.x <= high.x && first[0] < last[0] && first[1] < last[1]).then_some((first, last))
    }

    fn read(&self, low: [usize; 2], high: [usize; 2]) -> Result<Window, SourceError> {
        let size = [high[0] - low[0], high[1] - low[1]];
        let mut window = Window {
            first: low,
            size,
            heights: vec![f32::NAN; size[0] * size[1]],
        };
        for file in &self.files {
            file.read_into(&mut window)?;
        }
        Ok(window)
    }
}

impl OpenFile {
    /// Lays the file's known pixels over the window.
    fn read_into(&self, window: &mut Window) -> Result<(), SourceError> {
        let from = [0, 1].map(|axis| window.first[axis].max(self.place.first[axis]));
        let to = [0, 1].map(|axis| {
            (window.first[axis] + window.size[axis]).min(self.place.first[axis] + self.place.size[axis])
        });
        if from[0] >= to[0] || from[1] >= to[1] {
            return Ok(());
        }
        let size = (to[0] - from[0], to[1] - from[1]);
        let corner = [0, 1].map(|axis| (from[axis] - self.place.first[axis]) as isize);
        let bad = |error: gdal::errors::GdalError| damaged(&self.place.path, &error);
        let band = self.dataset.rasterband(1).map_err(bad)?;
        let buffer = band
            .read_as::<f64>((corner[0], corner[1]), size, size, None::<ResampleAlg>)
            .map_err(bad)?;
        for (row, values) in buffer.data().chunks_exact(size.0).enumerate() {
            let start = (from[1] - window.first[1] + row) * window.size[0] + from[0] - window.first[0];
            for (height, &value) in window.heights[start..].iter_mut().zip(values) {
                let metres = value * self.scale + self.offset;
                let missing = self.no_data.is_some_and(|no_data| is_no_data(value, no_data));
                if !missing && value != UNDECLARED_NO_DATA && BELIEVABLE_M.contains(&metres) {
                    *height = metres as f32;
                }
            }
        }
        Ok(())
    }
}

fn damaged(path: &Path, error: &gdal::errors::GdalError) -> SourceError {
    SourceError::Read {
        path: path.to_owned(),
        why: error.to_string(),
    }
}

/// Nodata tags and values are often rounded differently (f32 and text): compare relatively.
fn is_no_data(value: f64, no_data: f64) -> bool {
    value == no_data || value.is_nan() || (value - no_data).abs() <= 1e-6 * no_data.abs()
}

fn open_raster(path: &Path) -> Result<Dataset, SourceError> {
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
        why: error.to_string(),
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
