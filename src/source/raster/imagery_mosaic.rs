//! Aerial orthophotos: any number of tiles in any CRS, warped by GDAL to a rectangle of the city.

use std::ffi::CString;
use std::path::{Path, PathBuf};

use gdal::raster::{Buffer, GdalDataType};
use gdal::{Dataset, DriverManager};

use super::whole_raster::require_all_samples;
use crate::source::{CrsChoice, SourceError, SourceRole, gdal_says, require_sound};
use crate::space::{Bounds, Crs, PointTransform};

/// Imagery files, in the order given; later ones lie on top.
#[derive(Clone, Debug)]
pub struct ImageryMosaic {
    files: Vec<ImageryFile>,
}

#[derive(Clone, Debug)]
struct ImageryFile {
    path: PathBuf,
    bounds: Bounds,
    pixel_m: f64,
    bands: usize,
    /// One band of indices into a colour table.
    is_paletted: bool,
    /// Value range that becomes 0..255, for orthophotos deeper than 8 bits.
    stretch: Option<[f64; 2]>,
    crs: Crs,
    /// The operation to the city's CRS as GDAL takes it; none where both are the same.
    to_city: Option<String>,
}

impl ImageryMosaic {
    /// Opens the headers; `city` is the CRS the orthophotos will be drawn in.
    pub fn open(files: &[PathBuf], choice: &CrsChoice, city: &Crs) -> Result<Self, SourceError> {
        let files = files
            .iter()
            .map(|path| ImageryFile::open(path, choice, city))
            .collect::<Result<_, _>>()?;
        Ok(Self { files })
    }

    /// The CRS of every file.
    pub fn all_crs(&self) -> impl Iterator<Item = &Crs> {
        self.files.iter().map(|file| &file.crs)
    }

    /// Files with their rectangles in the city's CRS and the sides of their pixels, metres.
    pub fn file_sizes(&self) -> impl Iterator<Item = (&Path, Bounds, f64)> {
        let files = self.files.iter();
        files.map(|file| (file.path.as_path(), file.bounds, file.pixel_m))
    }

    /// Side of the finest orthophoto's pixel, metres.
    pub fn finest_pixel_m(&self) -> f64 {
        self.files
            .iter()
            .map(|file| file.pixel_m)
            .fold(f64::INFINITY, f64::min)
    }

    /// True when an orthophoto may cover part of the rectangle.
    pub fn meets(&self, bounds: &Bounds) -> bool {
        self.files.iter().any(|file| file.bounds.meets(bounds))
    }

    /// Files that lie nowhere in a rectangle of the city.
    pub fn files_outside(&self, bounds: &Bounds) -> impl Iterator<Item = &Path> {
        let files = self.files.iter().filter(|file| !file.bounds.meets(bounds));
        files.map(|file| file.path.as_path())
    }

    /// Warps all orthophotos that meet the rectangle into `side` x `side` RGBA pixels, rows from the north.
    /// Alpha is 0 where no orthophoto is.
    pub fn warp(&self, city: &Crs, bounds: &Bounds, side: usize) -> Result<Vec<u8>, SourceError> {
        let mut rgba = vec![0_u8; 4 * side * side];
        for file in self.files.iter().filter(|file| file.bounds.meets(bounds)) {
            file.warp_over(city, bounds, side, &mut rgba)?;
        }
        Ok(rgba)
    }
}

impl ImageryFile {
    fn open(path: &Path, choice: &CrsChoice, city: &Crs) -> Result<Self, SourceError> {
        let open_error = |error: gdal::errors::GdalError| SourceError::Open {
            path: path.to_owned(),
            why: gdal_says(&error),
            expected: "raster",
        };
        require_sound(path)?;
        let dataset = Dataset::open(path).map_err(open_error)?;
        require_all_samples(path, &dataset)?;
        let crs_error = |source| SourceError::Crs {
            path: path.to_owned(),
            source,
        };
        let crs = choice.of_file(path, dataset.spatial_ref().ok(), SourceRole::Imagery)?;
        let transform = dataset.geo_transform().map_err(|_| SourceError::Unfit {
            path: path.to_owned(),
            what: "has no georeference".to_owned(),
            advice: "add a world file or assign one with gdal_edit.py -a_ullr".to_owned(),
        })?;
        let (width, height) = dataset.raster_size();
        let bands = dataset.raster_count();
        if bands == 0 || width == 0 || height == 0 {
            return Err(SourceError::Unfit {
                path: path.to_owned(),
                what: "holds no raster".to_owned(),
                advice: "give an aerial photo".to_owned(),
            });
        }
        let is_paletted = bands < 3
            && dataset
                .rasterband(1)
                .is_ok_and(|band| band.color_table().is_some());
        let to_city = PointTransform::new(&crs, city).map_err(crs_error)?;
        let mut bounds = Bounds::EMPTY;
        for step in 0..4 * 17_u32 {
            let (side, along) = (step % 4, f64::from(step / 4) / 16.0);
            let (u, v) = [(along, 0.0), (along, 1.0), (0.0, along), (1.0, along)][side as usize];
            let (column, row) = (u * width as f64, v * height as f64);
            let x = transform[0] + column * transform[1] + row * transform[2];
            let y = transform[3] + column * transform[4] + row * transform[5];
            if let Some(point) = to_city.point(glam::DVec2::new(x, y)) {
                bounds.include(point.x, point.y);
            }
        }
        let stretch = if is_paletted { Ok(None) } else { stretch(&dataset) };
        let stretch = stretch.map_err(|error| SourceError::Read {
            path: path.to_owned(),
            why: gdal_says(&error),
        })?;
        Ok(Self {
            path: path.to_owned(),
            pixel_m: (bounds.width() / width as f64).min(bounds.height() / height as f64),
            bounds,
            bands,
            is_paletted,
            stretch,
            to_city: to_city
                .operation()
                .map(|operation| operation.pipeline_in_axis_order.clone()),
            crs,
        })
    }

    fn warp_over(
        &self,
        city: &Crs,
        bounds: &Bounds,
        side: usize,
        rgba: &mut [u8],
    ) -> Result<(), SourceError> {
        let read_error = |why: String| SourceError::Read {
            path: self.path.clone(),
            why,
        };
        let gdal_error = |error: gdal::errors::GdalError| read_error(gdal_says(&error));
        let source = Dataset::open(&self.path).map_err(gdal_error)?;
        let source = if self.is_paletted {
            in_colour(&source).map_err(read_error)?
        } else {
            source
        };
        let colours = if self.bands >= 3 || self.is_paletted { 3 } else { 1 };
        let pixel_m = bounds.width() / side as f64;
        let mut options = vec!["-of".into(), "MEM".into(), "-dstalpha".into()];
        options.extend([
            "-ot".into(),
            "Float32".into(),
            "-t_srs".into(),
            city.label().into(),
        ]);
        options.push("-te".into());
        options
            .extend([bounds.west, bounds.south, bounds.east, bounds.north].map(|edge| format!("{edge:.9}")));
        options.extend(["-ts".into(), side.to_string(), side.to_string()]);
        let method = if pixel_m > 1.5 * self.pixel_m {
            "average"
        } else {
            "cubic"
        };
        options.extend(["-r".into(), method.into()]);
        options.extend(["-s_srs".into(), self.crs.label().into()]);
        if let Some(operation) = &self.to_city {
            options.extend(["-ct".into(), operation.clone()]);
        }
        let warped = warp(&source, &options).map_err(read_error)?;
        let band_count = warped.raster_count();
        let read = |index: usize| -> Result<Buffer<f32>, SourceError> {
            let band = warped.rasterband(index).map_err(gdal_error)?;
            band.read_band_as::<f32>().map_err(gdal_error)
        };
        let alpha = read(band_count)?;
        let [low, high] = self.stretch.unwrap_or([0.0, 255.0]).map(|value| value as f32);
        let alpha_full = alpha.data().iter().copied().fold(1.0_f32, f32::max);
        for channel in 0..3 {
            let band = read(1 + channel.min(colours - 1))?;
            for (k, value) in band.data().iter().enumerate() {
                if alpha.data()[k] > 0.5 * alpha_full {
                    let grey = (value - low) / (high - low) * 255.0;
                    rgba[4 * k + channel] = grey.clamp(0.0, 255.0).round() as u8;
                    rgba[4 * k + 3] = 255;
                }
            }
        }
        Ok(())
    }
}

/// The 1st to 99th percentile of deeper-than-8-bit orthophotos, of a sample of their pixels.
fn stretch(dataset: &Dataset) -> Result<Option<[f64; 2]>, gdal::errors::GdalError> {
    let band = dataset.rasterband(1)?;
    if band.band_type() == GdalDataType::UInt8 {
        return Ok(None);
    }
    let (width, height) = dataset.raster_size();
    let sample = (width.min(512), height.min(512));
    let buffer = band.read_as::<f64>((0, 0), (width, height), sample, None)?;
    let no_data = band.no_data_value();
    let mut values: Vec<f64> = buffer
        .data()
        .iter()
        .copied()
        .filter(|value| value.is_finite() && Some(*value) != no_data)
        .collect();
    values.sort_by(f64::total_cmp);
    let at = |share: f64| {
        values
            .get((share * (values.len() as f64 - 1.0)) as usize)
            .copied()
    };
    Ok(match (at(0.01), at(0.99)) {
        (Some(low), Some(high)) if high > low => Some([low, high]),
        _ => None,
    })
}

/// `gdal_translate -expand rgba` as it is read: colours can be averaged, indices into a table cannot.
fn in_colour(source: &Dataset) -> Result<Dataset, String> {
    let options = ["-of", "VRT", "-expand", "rgba"].map(str::to_owned);
    let (_texts, mut pointers) = c_strings(&options)?;
    let destination = CString::default();
    // SAFETY: every pointer outlives the call; the returned handle is checked and owned by `Dataset`.
    unsafe {
        let parsed = gdal_sys::GDALTranslateOptionsNew(pointers.as_mut_ptr(), std::ptr::null_mut());
        if parsed.is_null() {
            return Err("gdal_translate refused its options".to_owned());
        }
        let mut usage_error = 0;
        let made =
            gdal_sys::GDALTranslate(destination.as_ptr(), source.c_dataset(), parsed, &mut usage_error);
        gdal_sys::GDALTranslateOptionsFree(parsed);
        owned(made)
    }
}

/// Options as GDAL wants them: texts, and pointers to them with a null at the end.
fn c_strings(options: &[String]) -> Result<(Vec<CString>, Vec<*mut std::ffi::c_char>), String> {
    let texts = options
        .iter()
        .map(|option| CString::new(option.as_str()).map_err(|error| error.to_string()))
        .collect::<Result<Vec<_>, _>>()?;
    let mut pointers: Vec<_> = texts.iter().map(|text| text.as_ptr().cast_mut()).collect();
    pointers.push(std::ptr::null_mut());
    Ok((texts, pointers))
}

/// A dataset that GDAL made, or what it says went wrong.
///
/// # Safety
/// The handle is null or a dataset that nobody else closes.
unsafe fn owned(made: gdal_sys::GDALDatasetH) -> Result<Dataset, String> {
    // SAFETY: GDAL's last message is a valid string until the next call; the handle is the caller's promise.
    unsafe {
        if made.is_null() {
            let message = std::ffi::CStr::from_ptr(gdal_sys::CPLGetLastErrorMsg());
            return Err(message.to_string_lossy().into_owned());
        }
        Ok(Dataset::from_c_dataset(made))
    }
}

/// `gdalwarp` on open datasets into memory.
fn warp(source: &Dataset, options: &[String]) -> Result<Dataset, String> {
    DriverManager::register_all();
    let (_texts, mut pointers) = c_strings(options)?;
    let destination = CString::default();
    let mut handles = [source.c_dataset()];
    // SAFETY: every pointer outlives the call; the returned handle is checked and owned by `Dataset`.
    unsafe {
        let parsed = gdal_sys::GDALWarpAppOptionsNew(pointers.as_mut_ptr(), std::ptr::null_mut());
        if parsed.is_null() {
            return Err("gdalwarp refused its options".to_owned());
        }
        let mut usage_error = 0;
        let warped = gdal_sys::GDALWarp(
            destination.as_ptr(),
            std::ptr::null_mut(),
            1,
            handles.as_mut_ptr(),
            parsed,
            &mut usage_error,
        );
        gdal_sys::GDALWarpAppOptionsFree(parsed);
        owned(warped)
    }
}
