//! Facades of the user's own: pictures of two bays by one storey, instead of painted ones.

use std::io::Cursor;

use image::imageops::FilterType;
use image::{ImageFormat, ImageReader, Limits};
use serde::Deserialize;

use super::canvas::{Canvas, TILE_SIZE, Texel};
use super::facade_painter::FacadeBand;

/// Most of them in a file of rules: the code of a building has room for some more.
pub const MAX_OWN_FACADES: usize = 16;
/// Most pixels along a picture's side.
const MAX_SIDE: u32 = 4096;
/// Sizes that a bay and a storey may have, metres.
const SIZES_M: std::ops::RangeInclusive<f64> = 0.5..=50.0;

/// A facade as a file of rules describes it. Names of pictures count from the folder `facades` beside the file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnFacade {
    /// What rules call it.
    pub name: String,
    /// The width that a bay comes near to, metres.
    pub bay_m: f64,
    /// The height that a storey comes near to, metres.
    pub storey_m: f64,
    /// Picture of the storeys between.
    pub middle: String,
    /// Of the ground floor; `middle` without.
    pub ground: Option<String>,
    /// Of a ground floor of shops; `ground` without.
    pub shop: Option<String>,
    /// Of the uppermost storey; `middle` without.
    pub top: Option<String>,
}

impl OwnFacade {
    /// Its pictures, a band each.
    pub fn pictures(&self) -> [&str; FacadeBand::ALL.len()] {
        FacadeBand::ALL.map(|band| {
            let own = match band {
                FacadeBand::Ground => self.ground.as_deref(),
                FacadeBand::Shop => self.shop.as_deref().or(self.ground.as_deref()),
                FacadeBand::Middle => None,
                FacadeBand::Top => self.top.as_deref(),
            };
            own.unwrap_or(&self.middle)
        })
    }

    /// What is wrong with it.
    pub(super) fn fault(&self) -> Option<&'static str> {
        let is_plain = |name: &&str| {
            name.len() < 100
                && name.ends_with(".png")
                && !name.starts_with('.')
                && !name.contains(['/', '\\', ':'])
        };
        if !self.pictures().iter().all(is_plain) {
            return Some("its pictures are to be names of PNG files in the folder 'facades', without a path");
        }
        let is_sane = SIZES_M.contains(&self.bay_m) && SIZES_M.contains(&self.storey_m);
        (!is_sane).then_some("bay_m and storey_m are to be 0.5 to 50 metres")
    }
}

/// A picture as a tile, from its PNG file's bytes; what is transparent is glass. The error says what is wrong.
pub fn facade_from_picture(bytes: &[u8], size_m: [f64; 2]) -> Result<Canvas, String> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    reader.limits(limits);
    let picture = reader.decode().map_err(|error| error.to_string())?;
    let [width, height] = TILE_SIZE.map(|side| side as u32);
    let picture = picture
        .resize_exact(width, height, FilterType::Triangle)
        .into_rgba8();
    let size_m = size_m.map(|side| side as f32);
    Ok(Canvas::new(size_m, |[x, y]| {
        let column = (x / size_m[0] * width as f32) as u32;
        // Rows of a picture run from above.
        let row = height - 1 - ((y / size_m[1] * height as f32) as u32).min(height - 1);
        let [r, g, b, opacity] = picture.get_pixel(column.min(width - 1), row).0;
        Texel {
            albedo: [r, g, b].map(|code| linear(f32::from(code) / 255.0)),
            height_m: 0.0,
            glass: 1.0 - f32::from(opacity) / 255.0,
            tint: 0.0,
        }
    }))
}

/// IEC 61966-2-1.
fn linear(code: f32) -> f32 {
    match code <= 0.040_45 {
        true => code / 12.92,
        false => ((code + 0.055) / 1.055).powf(2.4),
    }
}
