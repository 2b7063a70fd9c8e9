//! What a survey file is: its kind, its CRS and what it holds, told from its header.

use std::path::{Path, PathBuf};

use gdal::raster::GdalDataType;
use gdal::{Dataset, DatasetOptions, GdalOpenFlags};

use super::spatial_reference::crs_from_gdal;
use super::{CrsChoice, FootprintSource, HeightRule, SourceError, gdal_says, require_sound};
use crate::space::Crs;

/// What a file can be taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurveyKind {
    /// Heights of the ground.
    Terrain,
    /// Outlines of buildings.
    Footprints,
    /// Orthophotos.
    Imagery,
}

impl SurveyKind {
    /// All, with their names.
    pub const ALL: [(Self, &str); 3] = [
        (Self::Terrain, "terrain"),
        (Self::Footprints, "buildings"),
        (Self::Imagery, "imagery"),
    ];
}

/// What was found in a file.
#[derive(Clone, Debug)]
pub struct SurveyFile {
    /// The file.
    pub path: PathBuf,
    /// What it is taken for.
    pub kind: SurveyKind,
    /// Its CRS in words; none when it names none.
    pub crs: Option<String>,
    /// Lines that tell what it holds.
    pub holds: Vec<String>,
}

/// Fields that a line names at most.
const MAX_FIELDS: usize = 12;
/// Height of a storey where heights are counted in them, metres; only told.
const STOREY_M: f64 = 3.2;

/// Looks into a file.
///
/// # Errors
/// When GDAL opens it neither as a raster nor as vectors.
pub fn identify(path: &Path) -> Result<SurveyFile, SourceError> {
    require_sound(path)?;
    let options = DatasetOptions {
        open_flags: GdalOpenFlags::GDAL_OF_RASTER | GdalOpenFlags::GDAL_OF_READONLY,
        ..DatasetOptions::default()
    };
    match Dataset::open_ex(path, options) {
        Ok(raster) if raster.raster_count() > 0 => identify_raster(path, &raster),
        _ => identify_vectors(path),
    }
}

fn identify_raster(path: &Path, raster: &Dataset) -> Result<SurveyFile, SourceError> {
    let (width, height) = raster.raster_size();
    let failed = |error: gdal::errors::GdalError| SourceError::Open {
        path: path.to_owned(),
        why: gdal_says(&error),
        expected: "raster",
    };
    let bands = raster.raster_count();
    let kind_of_samples = raster.rasterband(1).map_err(failed)?.band_type();
    let is_colour = bands >= 3 || (bands == 1 && kind_of_samples == GdalDataType::UInt8);
    let crs = raster.spatial_ref().ok().and_then(|own| crs_from_gdal(&own).ok());
    let pixel = raster
        .geo_transform()
        .map(|[_, x, _, _, _, y]| [x.abs(), y.abs()]);
    let mut holds = vec![format!(
        "{width} x {height} pixels, {bands} x {}",
        kind_of_samples.name()
    )];
    if let Ok([x, y]) = pixel {
        holds.push(format!("a pixel is {x:.6} x {y:.6} units of its CRS"));
    }
    Ok(SurveyFile {
        path: path.to_owned(),
        kind: if is_colour {
            SurveyKind::Imagery
        } else {
            SurveyKind::Terrain
        },
        crs: crs.as_ref().map(in_words),
        holds,
    })
}

fn identify_vectors(path: &Path) -> Result<SurveyFile, SourceError> {
    // A CRS to fall back to, so that one that names none can be told.
    let globe = Crs::wgs84().ok();
    let source = FootprintSource::open(path, None, &CrsChoice::new(None, globe.as_ref()))?;
    let (layer, features) = source.layer_size()?;
    let names_crs = source.names_crs()?;
    let mut fields = source.field_names()?;
    let more = fields.len().saturating_sub(MAX_FIELDS);
    fields.truncate(MAX_FIELDS);
    let mut named = fields.join(", ");
    if more > 0 {
        named.push_str(&format!(" and {more} more"));
    }
    let heights = match source.known_height_rule(STOREY_M)? {
        HeightRule::KnownFields { fields } => {
            let texts: Vec<String> = fields.iter().map(ToString::to_string).collect();
            format!("heights: {}", texts.join(", then "))
        }
        _ => "heights: no field of a known name; all get the default height".to_owned(),
    };
    Ok(SurveyFile {
        path: path.to_owned(),
        kind: SurveyKind::Footprints,
        crs: names_crs.then(|| in_words(source.crs())),
        holds: vec![
            format!("layer {layer}, {features} features"),
            format!("fields: {named}"),
            heights,
        ],
    })
}

/// Code and name of a CRS.
fn in_words(crs: &Crs) -> String {
    match crs.label() == crs.name() {
        true => crs.name().to_owned(),
        false => format!("{} ({})", Crs::short_label(crs.label()), crs.name()),
    }
}
