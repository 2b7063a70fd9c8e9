//! PNG pictures, linear radiance as TIFF or OpenEXR, and depth and ids as single-band TIFFs.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;
use tiff::encoder::{TiffEncoder, colortype};

/// A picture file could not be written.
#[derive(Debug, Error)]
#[error("{}: cannot be written ({why})", path.display())]
pub struct OutputError {
    /// The file.
    pub path: PathBuf,
    /// What the system said.
    pub why: String,
}

fn output_error(path: &Path) -> impl Fn(String) -> OutputError + use<'_> {
    |why| OutputError {
        path: path.to_owned(),
        why,
    }
}

/// Writes 8-bit RGBA rows, from the top, as an RGB PNG.
pub fn write_png(path: &Path, size: [u32; 2], rgba: &[u8]) -> Result<(), OutputError> {
    let rgb: Vec<u8> = rgba
        .chunks_exact(4)
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    image::save_buffer_with_format(
        path,
        &rgb,
        size[0],
        size[1],
        image::ExtendedColorType::Rgb8,
        image::ImageFormat::Png,
    )
    .map_err(|error| output_error(path)(error.to_string()))
}

/// Writes metres along the view ray, NaN = sky.
pub fn write_depth(path: &Path, size: [u32; 2], depth: &[f32]) -> Result<(), OutputError> {
    write_tiff::<colortype::Gray32Float>(path, size, depth)
}

/// Writes building ids, 0 = ground or sky.
pub fn write_ids(path: &Path, size: [u32; 2], ids: &[u32]) -> Result<(), OutputError> {
    write_tiff::<colortype::Gray32>(path, size, ids)
}

/// Bytes of pixels up to which a TIFF is a classic one, whose offsets have 32 bits.
const MAX_CLASSIC_TIFF: u64 = 4_000_000_000;

fn write_tiff<C: colortype::ColorType>(
    path: &Path,
    size: [u32; 2],
    values: &[C::Inner],
) -> Result<(), OutputError>
where
    [C::Inner]: tiff::encoder::TiffValue,
{
    let error = output_error(path);
    let file = File::create(path).map_err(|why| error(why.to_string()))?;
    let mut writer = BufWriter::new(file);
    let [width, height] = size;
    let written = if size_of_val(values) as u64 > MAX_CLASSIC_TIFF {
        TiffEncoder::new_big(&mut writer)
            .and_then(|mut encoder| encoder.write_image::<C>(width, height, values))
    } else {
        TiffEncoder::new(&mut writer).and_then(|mut encoder| encoder.write_image::<C>(width, height, values))
    };
    written.map_err(|why| error(why.to_string()))?;
    writer.flush().map_err(|why| error(why.to_string()))
}

/// What an image's file holds, by its ending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageKind {
    /// 8-bit sRGB: .png.
    Display,
    /// Linear radiance in a TIFF: .tif, .tiff.
    RadianceTiff,
    /// Linear radiance in OpenEXR: .exr.
    RadianceExr,
}

/// The kind that a path's ending names.
///
/// # Errors
/// When it names none.
pub fn image_kind(path: &Path) -> Result<ImageKind, OutputError> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("png") => Ok(ImageKind::Display),
        Some("tif" | "tiff") => Ok(ImageKind::RadianceTiff),
        Some("exr") => Ok(ImageKind::RadianceExr),
        _ => Err(output_error(path)(
            "name a file that ends in .png, or for linear radiance in .exr or .tif".to_owned(),
        )),
    }
}

/// Writes linear radiance, RGB, rows from the top: OpenEXR where the path says so, else a TIFF.
pub fn write_radiance(path: &Path, size: [u32; 2], radiance: &[[f32; 3]]) -> Result<(), OutputError> {
    if image_kind(path).is_ok_and(|kind| kind == ImageKind::RadianceExr) {
        return write_exr(path, size, radiance);
    }
    write_tiff::<colortype::RGB32Float>(path, size, radiance.as_flattened())
}

/// The same as OpenEXR, whatever the path's ending.
pub fn write_exr(path: &Path, size: [u32; 2], radiance: &[[f32; 3]]) -> Result<(), OutputError> {
    image::save_buffer_with_format(
        path,
        bytemuck::cast_slice(radiance),
        size[0],
        size[1],
        image::ExtendedColorType::Rgb32F,
        image::ImageFormat::OpenExr,
    )
    .map_err(|error| output_error(path)(error.to_string()))
}

/// Most pixels of a drawing.
const MAX_DRAWING_PIXELS: u64 = 64_000_000;

/// Writes a drawing as it is (.svg) or drawn out (.png), by the path's ending.
pub fn write_drawing(path: &Path, svg: &str) -> Result<(), OutputError> {
    use resvg::{tiny_skia, usvg};
    let error = output_error(path);
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("svg") => std::fs::write(path, svg).map_err(|why| error(why.to_string())),
        Some("png") => {
            let tree =
                usvg::Tree::from_str(svg, &usvg::Options::default()).map_err(|why| error(why.to_string()))?;
            let size = tree.size().to_int_size();
            if u64::from(size.width()) * u64::from(size.height()) > MAX_DRAWING_PIXELS {
                return Err(error(format!(
                    "the drawing would have {} x {} pixels; check its lengths",
                    size.width(),
                    size.height()
                )));
            }
            let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height())
                .ok_or_else(|| error("the drawing has no size".to_owned()))?;
            resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixels.as_mut());
            // The drawing's ground is opaque, so that nothing is left to divide by its alpha.
            write_png(path, [size.width(), size.height()], pixels.data())
        }
        _ => Err(error("name a file that ends in .svg or .png".to_owned())),
    }
}
