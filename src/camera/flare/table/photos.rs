//! Photos and videos of a small light at known angles, as a table of images (KR 10-1658883, claims 3 and 16).
//!
//! The list is a CSV file: `file,theta_deg` and, where the light was also turned round the axis, `phi_deg` (from right towards
//! up). Files count from the list's folder; PNG or JPEG with sRGB values. A row with `at_s` is the picture at that time of a video;
//! between two such rows of one video and one `phi_deg` the light moved evenly, and a picture is taken at every degree.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Seek};
use std::path::{Path, PathBuf};

use image::DynamicImage;
use serde::Deserialize;

use super::video_frames::video_frame;
use super::{ImageTable, LightImage, TableError};
use crate::source::open_regular;

/// Photos are reduced until neither side is longer, pixels.
const MAX_PIXELS: u32 = 480;
/// Most pixels of a photo's side, and most bytes it may take while it is read.
const MAX_PHOTO_SIDE: u32 = 20_000;
const MAX_PHOTO_BYTES: u64 = 1 << 30;

/// Angle between two pictures of a video, at most, degrees; and most pictures in a table.
const VIDEO_STEP_DEG: f64 = 1.0;
const MAX_IMAGES: usize = 600;

#[derive(Clone, Deserialize)]
struct Row {
    file: PathBuf,
    theta_deg: f64,
    #[serde(default)]
    phi_deg: f64,
    /// In a video.
    #[serde(default)]
    at_s: Option<f64>,
}

impl Row {
    fn is_sound(&self) -> bool {
        let at_s = self.at_s.unwrap_or(0.0);
        (0.0..90.0).contains(&self.theta_deg) && self.phi_deg.is_finite() && (0.0..1e6).contains(&at_s)
    }
}

/// The rows, and between two of one video those of the angles that the light passed.
fn with_passed_angles(rows: &[Row]) -> Vec<Row> {
    let mut all: Vec<Row> = Vec::new();
    for row in rows {
        if let (Some(last), Some(to_s)) = (all.last().cloned(), row.at_s)
            && let Some(from_s) = last.at_s
            && (&last.file, last.phi_deg) == (&row.file, row.phi_deg)
        {
            let span = row.theta_deg - last.theta_deg;
            let steps = (span.abs() / VIDEO_STEP_DEG - 1e-9).ceil().max(1.0);
            all.extend((1..steps as u32).map(|k| {
                let along = f64::from(k) / steps;
                Row {
                    theta_deg: last.theta_deg + along * span,
                    at_s: Some(from_s + along * (to_s - from_s)),
                    ..row.clone()
                }
            }));
        }
        all.push(row.clone());
    }
    all
}

/// Reads the listed photos, less a photo taken with the light off where there is one. Their width spans `film_width_mm`; a
/// white pixel is radiance `white` under a light of irradiance 1. `with_linear` where the linear part is drawn beside them.
pub fn table_from_photos(
    list: &Path,
    dark: Option<&Path>,
    film_width_mm: f64,
    white: f32,
    with_linear: bool,
) -> Result<ImageTable, TableError> {
    let unfit = |path: &Path, why: String| TableError::Photos {
        path: path.to_owned(),
        why,
    };
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_path(list)
        .map_err(|error| unfit(list, error.to_string()))?;
    let rows: Vec<Row> = reader.deserialize().collect::<Result<_, _>>().map_err(|error| {
        unfit(
            list,
            format!("{error}; its columns are file,theta_deg[,phi_deg][,at_s]"),
        )
    })?;
    if let Some(row) = rows.iter().find(|row| !row.is_sound()) {
        return Err(unfit(
            list,
            format!("{}: theta_deg must be 0 to 90, at_s a time", row.file.display()),
        ));
    }
    let rows = with_passed_angles(&rows);
    if rows.len() > MAX_IMAGES {
        return Err(unfit(
            list,
            format!("gives {} pictures, more than {MAX_IMAGES}", rows.len()),
        ));
    }
    if rows.is_empty() {
        return Err(unfit(list, "lists no photos".to_owned()));
    }
    let dark = dark.map(|path| linear(path, open(path)?)).transpose()?;
    let folder = list.parent().unwrap_or(Path::new(""));
    // One after the other: a photo of many megapixels takes a gigabyte while it is read.
    let images = rows
        .iter()
        .map(|row| {
            let path = folder.join(&row.file);
            let (mut light, size) = match row.at_s {
                Some(at_s) => {
                    let frame = video_frame(&path, at_s).map_err(|why| unfit(&path, why))?;
                    linear(&path, Cursor::new(frame))?
                }
                None => linear(&path, open(&path)?)?,
            };
            if let Some((dark, dark_size)) = &dark {
                if *dark_size != size {
                    return Err(unfit(
                        &path,
                        "is not as large as the photo with the light off".to_owned(),
                    ));
                }
                for (rgb, dark) in light.iter_mut().zip(dark) {
                    *rgb = [0, 1, 2].map(|k: usize| (rgb[k] - dark[k]).max(0.0));
                }
            }
            for rgb in &mut light {
                *rgb = rgb.map(|value| value * white);
            }
            let half_width = 0.5 * film_width_mm;
            let half_mm = [half_width, half_width * f64::from(size[1]) / f64::from(size[0])];
            let [angle, turn] = [row.theta_deg, row.phi_deg].map(f64::to_radians);
            Ok(LightImage::new(angle, turn, &light, size, half_mm))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let table = ImageTable::new(images, with_linear, None);
    if table.repeats() {
        return Err(unfit(list, "lists the same angles twice".to_owned()));
    }
    if !table.is_sound() {
        return Err(unfit(
            list,
            "gives values that are no light; check the radiance of white".to_owned(),
        ));
    }
    Ok(table)
}

fn open(photo: &Path) -> Result<BufReader<File>, TableError> {
    let file = open_regular(photo).map_err(|source| TableError::File {
        path: photo.to_owned(),
        source,
    })?;
    Ok(BufReader::new(file))
}

/// A photo's linear light, white = 1, reduced in size; and its columns and rows. `path`: for messages.
fn linear(path: &Path, photo: impl BufRead + Seek) -> Result<(Vec<[f32; 3]>, [u32; 2]), TableError> {
    let unfit = |why: String| TableError::Photos {
        path: path.to_owned(),
        why,
    };
    let mut reader = image::ImageReader::new(photo)
        .with_guessed_format()
        .map_err(|error| unfit(error.to_string()))?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_PHOTO_SIDE);
    limits.max_image_height = Some(MAX_PHOTO_SIDE);
    limits.max_alloc = Some(MAX_PHOTO_BYTES / 4);
    reader.limits(limits);
    let photo = reader
        .decode()
        .map_err(|error| unfit(format!("{error}; give PNG or JPEG")))?;
    let bytes = u64::from(photo.width()) * u64::from(photo.height()) * 12;
    if bytes > MAX_PHOTO_BYTES {
        return Err(unfit(format!(
            "{} x {} pixels are too many; reduce it to 9000 x 9000 at most",
            photo.width(),
            photo.height()
        )));
    }
    let mut encoded = photo.into_rgb32f();
    // IEC 61966-2-1: sums of light are sums of linear values.
    for value in encoded.iter_mut() {
        *value = if *value <= 0.040_45 {
            *value / 12.92
        } else {
            ((*value + 0.055) / 1.055).powf(2.4)
        };
    }
    let (width, height) = encoded.dimensions();
    let mut light = DynamicImage::from(encoded);
    let longer = width.max(height);
    if longer > MAX_PIXELS {
        let reduced = |side: u32| (u64::from(side) * u64::from(MAX_PIXELS) / u64::from(longer)).max(1) as u32;
        light = light.resize_exact(
            reduced(width),
            reduced(height),
            image::imageops::FilterType::Triangle,
        );
    }
    let light = light.into_rgb32f();
    let size = [light.width(), light.height()];
    Ok((light.pixels().map(|pixel| pixel.0).collect(), size))
}
