//! How values are written on the command line: points, sizes, angles.

use std::path::Path;

use glam::DVec3;

use super::CommandError;
use crate::city::{CityError, enclosing_city};

/// `E,N,H`.
pub fn point(text: &str) -> Result<DVec3, String> {
    match numbers(text, ',').as_deref() {
        Some(&[east, north, height]) => Ok(DVec3::new(east, north, height)),
        _ => Err("give three numbers: easting,northing,height".to_owned()),
    }
}

/// Degrees of a field of view.
pub fn field_of_view(text: &str) -> Result<f64, String> {
    let degrees: f64 = text.parse().map_err(|_| "give degrees".to_owned())?;
    if (0.1..=170.0).contains(&degrees) {
        Ok(degrees)
    } else {
        Err("give 0.1 to 170 degrees".to_owned())
    }
}

/// A part of a whole.
pub fn fraction(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(part) if (0.0..=1.0).contains(&part) => Ok(part),
        _ => Err("give a number from 0 to 1".to_owned()),
    }
}

/// A factor on light.
pub fn exposure(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(factor) if factor > 0.0 && factor < 1e6 => Ok(factor),
        _ => Err("give a number above 0".to_owned()),
    }
}

/// Longest side of what is drawn at once, and of what is drawn in windows, pixels.
const MAX_SIDE: u32 = 8192;
const MAX_IMAGE_SIDE: u32 = 65_535;
/// Most pixels of an image: 16 bytes of each, 28 with radiance, are held in memory.
const MAX_IMAGE_PIXELS: u64 = 1 << 29;

/// `WxH`, pixels, of what is drawn at once.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    sides(text, MAX_SIDE)
}

/// `WxH`, pixels, of what may be drawn in windows.
pub fn image_size(text: &str) -> Result<[u32; 2], String> {
    let [width, height] = sides(text, MAX_IMAGE_SIDE)?;
    if u64::from(width) * u64::from(height) > MAX_IMAGE_PIXELS {
        return Err(format!("give a size of at most {MAX_IMAGE_PIXELS} pixels"));
    }
    Ok([width, height])
}

fn sides(text: &str, max: u32) -> Result<[u32; 2], String> {
    let sides: Option<Vec<u32>> = text.split('x').map(|side| side.parse().ok()).collect();
    match sides.as_deref() {
        Some(&[width, height]) if (1..=max).contains(&width) && (1..=max).contains(&height) => {
            Ok([width, height])
        }
        _ => Err(format!("give a size like 1280x720, each side 1 to {max}")),
    }
}

/// `WxH`, millimetres of a sensor.
pub fn sensor(text: &str) -> Result<[f64; 2], String> {
    match numbers(text, 'x').as_deref() {
        Some(&[width, height]) if [width, height].iter().all(|side| (0.1..=1000.0).contains(side)) => {
            Ok([width, height])
        }
        _ => Err("give width and height in millimetres, such as 36x24".to_owned()),
    }
}

fn numbers(text: &str, separator: char) -> Option<Vec<f64>> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    text.split(separator).map(number).collect()
}

/// Fails before a file that was to be read is written over.
pub fn require_other(path: &Path, read: &[&Path]) -> Result<(), CommandError> {
    match read.iter().any(|read| is_same_file(path, read)) {
        false => Ok(()),
        true => Err(CommandError::File {
            path: path.display().to_string(),
            why: "is read, and would be written over; give another --out".to_owned(),
        }),
    }
}

/// Whether two paths are one file, through links of either kind; of files that do not exist yet, whether they are spelt alike.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let node = |path: &Path| std::fs::metadata(path).ok().map(|data| (data.dev(), data.ino()));
        if let Some(node_a) = node(a) {
            return node(b) == Some(node_a);
        }
    }
    let real = |path: &Path| {
        std::fs::canonicalize(path)
            .or_else(|_| std::path::absolute(path))
            .ok()
    };
    real(a).is_some_and(|a| real(b) == Some(a))
}

/// Fails when a file would lie among those of a city.
pub fn require_no_city(path: &Path) -> Result<(), CommandError> {
    match enclosing_city(path) {
        None => Ok(()),
        Some(city) => {
            let path = path.to_owned();
            Err(CityError::Inside { path, city }.into())
        }
    }
}

/// Fails before the long work when the result could not be written after it, or would lie among the files of a city.
pub fn require_place(path: &Path) -> Result<(), CommandError> {
    require_no_city(path)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if folder.is_none_or(Path::is_dir) {
        return Ok(());
    }
    Err(CommandError::File {
        path: path.display().to_string(),
        why: "its folder does not exist; make it first".to_owned(),
    })
}
