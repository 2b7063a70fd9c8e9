//! One mosaic source of terrain opened for reading: heights on a lattice of the city, bilinear in the file's own pixels.

use std::cell::RefCell;
use std::path::Path;

use gdal::raster::ResampleAlg;
use gdal::{Dataset, GeoTransformEx};
use glam::DVec2;

use super::mosaic_source::{MosaicFile, MosaicSource, SNAP_PIXELS, open_raster};
use super::window::Window;
use crate::source::{SourceError, gdal_says};
use crate::space::{Crs, PointTransform};

/// Lowest and highest believable ground, metres; beyond lie sentinels such as -32768 and 3.4e38.
const BELIEVABLE_M: std::ops::Range<f64> = -12_000.0..9_000.0;

/// What many writers put for missing ground without declaring it.
const UNDECLARED_NO_DATA: f64 = -9999.0;

/// Most pixels read at a time for one tile (64 MiB of f32).
const MAX_PIXELS: usize = 1 << 24;

/// Pixels read for a sample, at most, where there is a choice.
const PIXELS_A_SAMPLE: usize = 256;
/// Most files of a mosaic source that are open at a time: systems allow some thousand to all threads together.
const MAX_OPEN: usize = 24;

/// Samples between two points where the transformation to the file's CRS is computed exactly.
const TRANSFORM_STEP: usize = 16;

/// One mosaic source opened, with the way from the city's CRS to its pixels.
pub struct MosaicSampler {
    mosaic: MosaicSource,
    files: Vec<MosaicFile>,
    /// Those that are open, the one used last at the end.
    open: RefCell<Vec<(usize, OpenFile)>>,
    file_from_city: PointTransform,
}

/// One file of a mosaic source.
struct OpenFile {
    dataset: Dataset,
    no_data: Option<f64>,
    scale: f64,
    offset: f64,
}

impl MosaicSampler {
    pub fn open(mosaic: &MosaicSource, city: &Crs) -> Result<Self, SourceError> {
        Ok(Self {
            file_from_city: PointTransform::new(city, &mosaic.crs)
                .map_err(|source| mosaic.crs_error(source))?,
            mosaic: mosaic.clone(),
            files: mosaic.files.clone(),
            open: RefCell::default(),
        })
    }

    pub fn fill_lattice(
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
        let is_sparse =
            window_pixels > MAX_PIXELS / 16 && window_pixels > PIXELS_A_SAMPLE * size[0] * size[1];
        if (window_pixels > MAX_PIXELS || is_sparse) && size[1] > 1 {
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
        // One row of a raster that lies aslant: its samples are far apart in both directions.
        if (window_pixels > MAX_PIXELS || is_sparse) && size[0] > 1 {
            let half = size[0] / 2;
            let (west, east) = heights.split_at_mut(half);
            self.fill_lattice(origin, step, first, [half, 1], west)?;
            let next = [first[0] + half as i64, first[1]];
            return self.fill_lattice(origin, step, next, [size[0] - half, 1], east);
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
            let (column, row) = self.mosaic.pixel_from_ground.apply(point.x, point.y);
            DVec2::new(column, row)
        };
        if self.file_from_city.is_identity() {
            return (0..size[0] * size[1])
                .map(|k| {
                    let (i, j) = (first[0] + (k % size[0]) as i64, first[1] + (k / size[0]) as i64);
                    let pixel = to_pixel(origin + DVec2::new(i as f64, j as f64) * step);
                    DVec2::new(snapped(pixel.x), snapped(pixel.y))
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
        // Longitudes as the file counts them, which may go on beyond 180 degrees.
        if let Some(turn) = self.mosaic.crs.units_a_turn() {
            let centre = 0.5 * (self.mosaic.bounds.west + self.mosaic.bounds.east);
            for x in &mut xs {
                *x += turn * ((centre - *x) / turn).round();
            }
        }
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
        let [width, height] = self.mosaic.size;
        let clamp = |value: f64, count: usize| value.clamp(0.0, count as f64) as usize;
        let first = [clamp(low.x - 1.5, width), clamp(low.y - 1.5, height)];
        let last = [clamp(high.x + 2.5, width), clamp(high.y + 2.5, height)];
        (low.x <= high.x && first[0] < last[0] && first[1] < last[1]).then_some((first, last))
    }

    /// A block of pixels, smoothed where the source is.
    pub fn read(&self, low: [usize; 2], high: [usize; 2]) -> Result<Window, SourceError> {
        let Some(smoothing) = &self.mosaic.smoothing else {
            return self.read_stored(low, high);
        };
        let halo = smoothing.halo();
        let wide_low = low.map(|pixel| pixel.saturating_sub(halo));
        let wide_high = [0, 1].map(|axis| (high[axis] + halo).min(self.mosaic.size[axis]));
        let wide = self.read_stored(wide_low, wide_high)?;
        Ok(smoothing.smooth(&wide, low, high))
    }

    fn read_stored(&self, low: [usize; 2], high: [usize; 2]) -> Result<Window, SourceError> {
        let size = [high[0] - low[0], high[1] - low[1]];
        let mut window = Window {
            first: low,
            size,
            heights: vec![f32::NAN; size[0] * size[1]],
        };
        // Later files lie on top: what they leave open is seen from those below.
        for (index, place) in self.files.iter().enumerate().rev() {
            let is_read = self.read_into(&mut window, index, place)?;
            if is_read && window.heights.iter().all(|height| !height.is_nan()) {
                break;
            }
        }
        Ok(window)
    }

    /// Lays a file's known pixels over the window.
    fn read_into(&self, window: &mut Window, index: usize, place: &MosaicFile) -> Result<bool, SourceError> {
        let from = [0, 1].map(|axis| window.first[axis].max(place.first[axis]));
        let to = [0, 1]
            .map(|axis| (window.first[axis] + window.size[axis]).min(place.first[axis] + place.size[axis]));
        if from[0] >= to[0] || from[1] >= to[1] {
            return Ok(false);
        }
        let size = (to[0] - from[0], to[1] - from[1]);
        let corner = [0, 1].map(|axis| (from[axis] - place.first[axis]) as isize);
        let bad = |error: gdal::errors::GdalError| damaged(&place.path, &error);
        let mut open = self.open.borrow_mut();
        let file = match open.iter().position(|(known, _)| *known == index) {
            Some(known) => open.remove(known).1,
            None => {
                if open.len() >= MAX_OPEN {
                    open.remove(0);
                }
                OpenFile::open(place, self.mosaic.metres_per_unit)?
            }
        };
        open.push((index, file));
        let Some((_, file)) = open.last() else {
            return Ok(false);
        };
        let band = file.dataset.rasterband(1).map_err(bad)?;
        let buffer = band
            .read_as::<f64>((corner[0], corner[1]), size, size, None::<ResampleAlg>)
            .map_err(bad)?;
        for (row, values) in buffer.data().chunks_exact(size.0).enumerate() {
            let start = (from[1] - window.first[1] + row) * window.size[0] + from[0] - window.first[0];
            for (height, &value) in window.heights[start..].iter_mut().zip(values) {
                let metres = value * file.scale + file.offset;
                let missing = file.no_data.is_some_and(|no_data| is_no_data(value, no_data));
                let is_known = !missing && value != UNDECLARED_NO_DATA && BELIEVABLE_M.contains(&metres);
                if is_known && height.is_nan() {
                    *height = metres as f32;
                }
            }
        }
        Ok(true)
    }
}

impl OpenFile {
    fn open(place: &MosaicFile, metres_per_unit: f64) -> Result<Self, SourceError> {
        let dataset = open_raster(&place.path)?;
        let band = dataset.rasterband(1).map_err(|e| damaged(&place.path, &e))?;
        Ok(Self {
            no_data: band.no_data_value(),
            scale: band.scale().unwrap_or(1.0) * metres_per_unit,
            offset: band.offset().unwrap_or(0.0) * metres_per_unit,
            dataset,
        })
    }
}

/// A coordinate on a pixel's centre but for rounding, put there: its height is then the pixel's to the last bit.
fn snapped(pixel: f64) -> f64 {
    let centre = (pixel - 0.5).round() + 0.5;
    if (pixel - centre).abs() < SNAP_PIXELS {
        centre
    } else {
        pixel
    }
}

fn damaged(path: &Path, error: &gdal::errors::GdalError) -> SourceError {
    SourceError::Read {
        path: path.to_owned(),
        why: gdal_says(error),
    }
}

/// Nodata tags and values are often rounded differently (f32 and text): compare relatively.
fn is_no_data(value: f64, no_data: f64) -> bool {
    value == no_data || value.is_nan() || (value - no_data).abs() <= 1e-6 * no_data.abs()
}
