//! Whether a raster's file holds all samples that its header tells of: GDAL reads those beyond the end of a cut one as zeros.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use gdal::Dataset;

use crate::source::SourceError;
use crate::source::files::files_described;

/// Drivers of files that hold samples as they are, one after the other.
const RAW_DRIVERS: [&str; 10] = [
    "BT", "EHdr", "ENVI", "ISCE", "KRO", "PAux", "PNM", "ROI_PAC", "RRASTER", "SAGA",
];
/// How files begin that are packed all the same, and those of netCDF's classic format (netCDF User's Guide, appendix B).
const GZIP: &[u8] = &[0x1f, 0x8b];
const CLASSIC_NETCDF: &[u8] = b"CDF";
/// What ends a JPEG image (ITU-T T.81, B.1.1.3), and how near to the file's end that stands: within an image it does not occur.
const END_OF_IMAGE: [u8; 2] = [0xff, 0xd9];
const TAIL: u64 = 1 << 16;

/// The same for a mosaic some of whose bands are raw files.
fn require_raw_parts(
    path: &Path,
    (width, height): (usize, usize),
    dataset: &Dataset,
) -> Result<(), SourceError> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let raw = text.matches("VRTRawRasterBand").count();
    if raw == 0 {
        return Ok(());
    }
    let bytes = dataset
        .rasterband(1)
        .map_or(1, |band| band.band_type().bytes() as usize)
        * width
        * height;
    let short = files_described(path).into_iter().find(|file| {
        let length = std::fs::metadata(file).map_or(0, |data| data.len());
        file != path && length < bytes as u64
    });
    match short {
        Some(file) => Err(SourceError::Read {
            why: format!(
                "it has fewer than the {bytes} bytes that {} tells of",
                path.display()
            ),
            path: file,
        }),
        None => Ok(()),
    }
}

/// Refuses a file that was cut, in formats whose reader does not notice.
///
/// # Errors
/// When samples are missing.
pub fn require_all_samples(path: &Path, dataset: &Dataset) -> Result<(), SourceError> {
    let damaged = |why: String| SourceError::Read {
        path: path.to_owned(),
        why,
    };
    let Ok(mut file) = File::open(path) else {
        return Ok(());
    };
    let length = file.metadata().map_or(0, |data| data.len());
    let driver = dataset.driver().short_name();
    if driver == "JPEG" {
        let ended = file
            .seek(SeekFrom::Start(length.saturating_sub(TAIL)))
            .and_then(|_| {
                let mut tail = Vec::new();
                file.read_to_end(&mut tail)?;
                Ok(tail.windows(2).any(|pair| pair == END_OF_IMAGE))
            });
        return match ended {
            Ok(true) => Ok(()),
            Ok(false) => Err(damaged("it ends within its image".to_owned())),
            Err(error) => Err(damaged(error.to_string())),
        };
    }
    let mut head = [0; 3];
    let begins_so = file.read_exact(&mut head).is_ok();
    let is_raw = RAW_DRIVERS.contains(&driver.as_str()) && !head.starts_with(GZIP);
    let is_classic = driver == "netCDF" && head.starts_with(CLASSIC_NETCDF);
    let (width, height) = dataset.raster_size();
    // Esri's float grid, of which GDAL takes the length for the kind of sample.
    let is_float = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("flt"));
    if driver == "EHdr" && is_float && length < 4 * (width * height) as u64 {
        return Err(damaged(format!(
            "it has {length} bytes of {}",
            4 * width * height
        )));
    }
    if driver == "VRT" {
        return require_raw_parts(path, (width, height), dataset);
    }
    let bytes: usize = (dataset.rasterbands().flatten())
        .map(|band| band.band_type().bytes() as usize * width * height)
        .sum();
    match begins_so && (is_raw || is_classic) && length < bytes as u64 {
        true => Err(damaged(format!("it has {length} bytes of {bytes} or more"))),
        false => Ok(()),
    }
}
