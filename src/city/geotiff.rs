//! GeoTIFF pages in pure Rust (`tiff`): OGC 19-008r4, keys and tags by their names there.

use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::Path;

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::encoder::colortype::{ColorType, Gray32, Gray32Float, RGBA8};
use tiff::encoder::compression::DeflateLevel;
use tiff::encoder::{Compression, Predictor, TiffEncoder, TiffValue};
use tiff::tags::Tag;

use super::CityError;
use super::city_files::open_plain;
use super::durable::create;
use crate::space::Crs;

/// Pixel values of one page, row by row from the north.
pub enum Pixels {
    /// One f32 band.
    Float(Vec<f32>),
    /// One u32 band.
    Word(Vec<u32>),
    /// Four u8 bands.
    Rgba(Vec<u8>),
}

/// One image of a TIFF file.
pub struct Page {
    /// Columns and rows.
    pub size: [usize; 2],
    /// The values.
    pub pixels: Pixels,
    /// Easting of the west edge, northing of the north edge, side of a pixel; none for tables.
    pub georeference: Option<[f64; 3]>,
    /// Whether pixels repeat, so that it pays to search for that.
    pub has_runs: bool,
}

/// How a CRS is written into GeoTIFF keys.
#[derive(Clone, Debug)]
pub struct GeoKeys {
    directory: Vec<u16>,
    ascii: String,
}

impl GeoKeys {
    /// Keys of a projected CRS: its EPSG code, or its ESRI WKT as GDAL reads it back.
    pub fn from_crs(crs: &Crs) -> Result<Self, CityError> {
        const MODEL_PROJECTED: u16 = 1;
        const RASTER_PIXEL_IS_AREA: u16 = 1;
        const USER_DEFINED: u16 = 32767;
        let code = crs
            .label()
            .strip_prefix("EPSG:")
            .and_then(|code| code.parse::<u16>().ok());
        let ascii = match code {
            Some(_) => String::new(),
            None => format!("ESRI PE String = {}|", crs.esri_wkt()?),
        };
        let mut keys: Vec<[u16; 4]> = vec![
            [1024, 0, 1, MODEL_PROJECTED],
            [1025, 0, 1, RASTER_PIXEL_IS_AREA],
            [3072, 0, 1, code.unwrap_or(USER_DEFINED)],
        ];
        if !ascii.is_empty() {
            keys.push([3073, 34737, ascii.len() as u16, 0]);
        }
        let mut directory = vec![1, 1, 0, keys.len() as u16];
        directory.extend(keys.into_iter().flatten());
        Ok(Self { directory, ascii })
    }
}

/// Writes pages to a file beside the target and renames it into place.
pub fn write(path: &Path, pages: &[Page], keys: &GeoKeys) -> Result<(), CityError> {
    let partial = path.with_extension("partial");
    let tile_error = |error: tiff::TiffError| CityError::File {
        path: path.to_owned(),
        why: error.to_string(),
    };
    let file = create(&partial).map_err(CityError::file(&partial))?;
    let mut writer = BufWriter::with_capacity(1 << 20, file);
    {
        let mut encoder = TiffEncoder::new(&mut writer).map_err(tile_error)?;
        for page in pages {
            // What repeats becomes smaller by more searching, a raster of runs or of heights by half; the rest is wanted sooner.
            let level = match page.pixels {
                Pixels::Float(_) => DeflateLevel::Balanced,
                _ if page.has_runs => DeflateLevel::Balanced,
                _ => DeflateLevel::Fast,
            };
            encoder = encoder.with_compression(Compression::Deflate(level));
            match &page.pixels {
                Pixels::Float(values) if !page.has_runs => {
                    write_page::<Gray32Float, _>(&mut encoder, page, &predicted(values, page.size[0]), keys)
                }
                Pixels::Float(values) => write_page::<Gray32Float, _>(&mut encoder, page, values, keys),
                Pixels::Word(values) => write_page::<Gray32, _>(&mut encoder, page, values, keys),
                Pixels::Rgba(values) => write_page::<RGBA8, _>(&mut encoder, page, values, keys),
            }
            .map_err(tile_error)?;
        }
    }
    writer.flush().map_err(CityError::file(&partial))?;
    drop(writer);
    std::fs::rename(&partial, path).map_err(CityError::file(path))
}

/// TIFF 6.0, section 18: the fourth channel is alpha, and the colours are not multiplied by it.
const UNASSOCIATED_ALPHA: u16 = 2;

fn write_page<C: ColorType, W: Write + std::io::Seek>(
    encoder: &mut TiffEncoder<W>,
    page: &Page,
    values: &[C::Inner],
    keys: &GeoKeys,
) -> tiff::TiffResult<()>
where
    [C::Inner]: TiffValue,
{
    let [width, height] = page.size.map(|count| count as u32);
    let mut image = encoder.new_image::<C>(width, height)?;
    if matches!(page.pixels, Pixels::Rgba(_)) {
        image
            .encoder()
            .write_tag(Tag::ExtraSamples, &[UNASSOCIATED_ALPHA][..])?;
    }
    if matches!(page.pixels, Pixels::Float(_)) && !page.has_runs {
        image
            .encoder()
            .write_tag(Tag::Predictor, Predictor::FloatingPoint.to_u16())?;
    }
    if let Some([west, north, pixel_m]) = page.georeference {
        let directory = image.encoder();
        directory.write_tag(Tag::ModelPixelScaleTag, &[pixel_m, pixel_m, 0.0][..])?;
        directory.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, west, north, 0.0][..])?;
        directory.write_tag(Tag::GeoKeyDirectoryTag, &keys.directory[..])?;
        if !keys.ascii.is_empty() {
            directory.write_tag(Tag::GeoAsciiParamsTag, keys.ascii.as_str())?;
        }
        if matches!(page.pixels, Pixels::Float(_)) {
            directory.write_tag(Tag::GdalNodata, "nan")?;
        }
    }
    image.write_data(values)
}

/// Rows of numbers as TIFF's floating-point predictor has them (Adobe Photoshop TIFF Technical Note 3): the bytes of a row by their
/// significance, each less the one before it. Smooth ground packs to a third.
fn predicted(values: &[f32], width: usize) -> Vec<f32> {
    let mut rows = Vec::with_capacity(values.len());
    for row in values.chunks_exact(width) {
        let planes = (0..4).flat_map(|byte| row.iter().map(move |value| value.to_be_bytes()[byte]));
        let mut before = 0_u8;
        let differences: Vec<u8> = planes
            .map(|byte| byte.wrapping_sub(std::mem::replace(&mut before, byte)))
            .collect();
        let (words, _) = differences.as_chunks::<4>();
        rows.extend(words.iter().map(|&word| f32::from_ne_bytes(word)));
    }
    rows
}

/// Most bytes of a page, unpacked: the two million outline vertices that a tile may have.
const MAX_PAGE_BYTES: usize = 1 << 25;

/// Reads pages, one after the other, checking each against what the city expects.
pub struct PageReader<'a> {
    path: &'a Path,
    decoder: Decoder<BufReader<File>>,
    first: bool,
}

impl<'a> PageReader<'a> {
    /// Opens a file.
    pub fn open(path: &'a Path) -> Result<Self, CityError> {
        let file = open_plain(path)?;
        let mut limits = Limits::default();
        limits.decoding_buffer_size = MAX_PAGE_BYTES;
        let decoder = Decoder::new(BufReader::with_capacity(1 << 18, file))
            .map_err(|error| damaged(path, error.to_string()))?
            .with_limits(limits);
        Ok(Self {
            path,
            decoder,
            first: true,
        })
    }

    /// Fails unless the page that was read last lies where it should: west and north border and side of a pixel, metres. A tile from
    /// another place would be drawn here.
    pub fn require_place(&mut self, [west, north, pixel_m]: [f64; 3]) -> Result<(), CityError> {
        let mut tag = |tag| self.decoder.get_tag_f64_vec(tag).unwrap_or_default();
        let (scale, tie) = (tag(Tag::ModelPixelScaleTag), tag(Tag::ModelTiepointTag));
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * pixel_m + 1e-12 * b.abs();
        let is_here = scale.len() == 3
            && tie.len() == 6
            && [
                (scale[0], pixel_m),
                (scale[1], pixel_m),
                (tie[3], west),
                (tie[4], north),
            ]
            .into_iter()
            .all(|(a, b)| near(a, b));
        match is_here {
            true => Ok(()),
            false => Err(damaged(
                self.path,
                "its georeference is that of another place".to_owned(),
            )),
        }
    }

    /// The next page as f32.
    pub fn floats(&mut self, size: [Option<usize>; 2]) -> Result<(Vec<f32>, [usize; 2]), CityError> {
        match self.next(size)? {
            (DecodingResult::F32(values), size) => Ok((values, size)),
            _ => Err(damaged(self.path, "a page is not of 32-bit floats".to_owned())),
        }
    }

    /// The next page as u32.
    pub fn words(&mut self, size: [Option<usize>; 2]) -> Result<(Vec<u32>, [usize; 2]), CityError> {
        match self.next(size)? {
            (DecodingResult::U32(values), size) => Ok((values, size)),
            _ => Err(damaged(self.path, "a page is not of 32-bit numbers".to_owned())),
        }
    }

    /// The next page as RGBA bytes.
    pub fn rgba(&mut self, size: [Option<usize>; 2]) -> Result<Vec<u8>, CityError> {
        match self.next(size)? {
            (DecodingResult::U8(values), [width, height]) if values.len() == 4 * width * height => Ok(values),
            _ => Err(damaged(self.path, "a page is not of RGBA bytes".to_owned())),
        }
    }

    /// Passes over the next page, which must have a size.
    pub fn skip(&mut self, size: [Option<usize>; 2]) -> Result<(), CityError> {
        self.turn_to_next(size).map(drop)
    }

    fn next(&mut self, size: [Option<usize>; 2]) -> Result<(DecodingResult, [usize; 2]), CityError> {
        let size = self.turn_to_next(size)?;
        let values = self
            .decoder
            .read_image()
            .map_err(|error| damaged(self.path, error.to_string()))?;
        Ok((values, size))
    }

    /// Reads the next page's directory; its size.
    fn turn_to_next(&mut self, size: [Option<usize>; 2]) -> Result<[usize; 2], CityError> {
        let path = self.path;
        let bad = |error: tiff::TiffError| damaged(path, error.to_string());
        if !self.first {
            self.decoder.next_image().map_err(bad)?;
        }
        self.first = false;
        let (width, height) = self.decoder.dimensions().map_err(bad)?;
        let found = [width as usize, height as usize];
        if (0..2).any(|axis| size[axis].is_some_and(|expected| expected != found[axis])) {
            return Err(damaged(
                path,
                format!("a page is {width} x {height}, expected {size:?}"),
            ));
        }
        // A pixel has four bytes.
        if found[0].saturating_mul(found[1]) > MAX_PAGE_BYTES / 4 {
            return Err(damaged(
                path,
                format!("a page of {width} x {height} is larger than any tile's"),
            ));
        }
        Ok(found)
    }
}

/// An error that names the tile.
pub fn damaged(path: &Path, why: String) -> CityError {
    CityError::Tile {
        path: path.to_owned(),
        why,
    }
}
