//! What an import is asked, and which askings are refused.

use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hasher};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::ground_plan::PlanFiles;
use super::progress::ImportProgress;
use crate::city::staging::beside;
use crate::city::{CityError, Layer, SourceRecord};
use crate::source::{HeightRule, PlanKind, files_of, open_regular};

/// What `rilievo import` was asked.
#[derive(Clone, Debug)]
pub struct ImportOptions {
    /// Terrain rasters.
    pub terrain: Vec<PathBuf>,
    /// Footprint file.
    pub buildings: PathBuf,
    /// Its layer.
    pub layer: Option<String>,
    /// Which attribute gives heights; none = those of known names.
    pub height_rule: Option<HeightRule>,
    /// Height of a storey where fields of known names count storeys, metres.
    pub storey_height_m: f64,
    /// Height of buildings without one, metres.
    pub default_height_m: f64,
    /// Aerial orthophotos.
    pub imagery: Vec<PathBuf>,
    /// The city's CRS; none = the terrain's if it will do, else the UTM zone.
    pub crs: Option<String>,
    /// CRS of terrain files that name none.
    pub terrain_crs: Option<String>,
    /// CRS of a footprint file that names none.
    pub buildings_crs: Option<String>,
    /// CRS of orthophotos that name none.
    pub imagery_crs: Option<String>,
    /// Metres per vertical unit of the terrain; none = what the files say.
    pub terrain_unit_m: Option<f64>,
    /// Heights stored in whole steps (whole metres) stay terraces.
    pub keep_steps: bool,
    /// Bound on the terrain mesh's error, metres.
    pub terrain_error_m: f64,
    /// Widest hole in the terrain that is filled, metres.
    pub fill_m: f64,
    /// Terrain kept around the buildings, metres.
    pub margin_m: f64,
    /// Side of a building-map texel, metres.
    pub texel_m: f64,
    /// What is drawn on the ground where no orthophoto is.
    pub plan: PlanFiles,
    /// Rules for facades; without it those of the city that is replaced, or the project's own.
    pub facades: Option<PathBuf>,
    /// The city folder to make.
    pub out: PathBuf,
    /// How far it is.
    pub progress: ImportProgress,
}

impl ImportOptions {
    /// Height of a storey, metres.
    pub const STOREY_HEIGHT_M: f64 = 3.2;
    /// Height of buildings without one, metres.
    pub const DEFAULT_HEIGHT_M: f64 = 6.0;
    /// Bound on the terrain mesh's error, metres.
    pub const TERRAIN_ERROR_M: f64 = 0.25;
    /// Widest hole in the terrain that is filled, metres.
    pub const FILL_M: f64 = 50.0;
    /// Terrain kept around the buildings, metres.
    pub const MARGIN_M: f64 = 2000.0;
    /// Side of a building-map texel, metres.
    pub const TEXEL_M: f64 = 1.0;

    /// Of some files, with all else as it is unless somebody says otherwise.
    pub fn new(terrain: Vec<PathBuf>, buildings: PathBuf, out: PathBuf) -> Self {
        Self {
            terrain,
            buildings,
            layer: None,
            height_rule: None,
            storey_height_m: Self::STOREY_HEIGHT_M,
            default_height_m: Self::DEFAULT_HEIGHT_M,
            imagery: Vec::new(),
            crs: None,
            terrain_crs: None,
            buildings_crs: None,
            imagery_crs: None,
            terrain_unit_m: None,
            keep_steps: false,
            terrain_error_m: Self::TERRAIN_ERROR_M,
            fill_m: Self::FILL_M,
            margin_m: Self::MARGIN_M,
            texel_m: Self::TEXEL_M,
            plan: PlanFiles::default(),
            facades: None,
            out,
            progress: ImportProgress::default(),
        }
    }
}

/// The old city is replaced whole, and what an import leaves beside it too: a source inside them would be lost.
pub fn refuse_inputs_inside(options: &ImportOptions, sources: &SourceFiles) -> Result<(), CityError> {
    let [partial, previous] = beside(&options.out);
    let folders: Vec<PathBuf> = [&options.out, &partial, &previous]
        .into_iter()
        .filter_map(|folder| std::fs::canonicalize(folder).ok())
        .collect();
    if folders.is_empty() {
        return Ok(());
    }
    for (input, files) in sources {
        let is_inside = |file: &Path| {
            let file = std::fs::canonicalize(file);
            file.is_ok_and(|file| folders.iter().any(|folder| file.starts_with(folder)))
        };
        if is_inside(input) || files.iter().any(|file| is_inside(file)) {
            return Err(CityError::InputInside { path: input.clone() });
        }
    }
    Ok(())
}

/// The files that an import's sources are made of, by source.
pub type SourceFiles = Vec<(PathBuf, BTreeSet<PathBuf>)>;

/// Lists them.
pub fn source_files(options: &ImportOptions) -> SourceFiles {
    inputs(options)
        .map(|path| (path.to_owned(), files_of(path)))
        .collect()
}

fn inputs(options: &ImportOptions) -> impl Iterator<Item = &Path> {
    let all = options
        .terrain
        .iter()
        .chain([&options.buildings])
        .chain(&options.imagery);
    all.map(PathBuf::as_path)
        .chain(options.plan.all().map(|(_, file)| file.as_path()))
}

/// A number that an import is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// Side of a building-map texel.
    Texel,
    /// Bound on the terrain mesh's error.
    TerrainError,
    /// Height of buildings without one.
    DefaultHeight,
    /// Widest hole in the terrain that is filled.
    Fill,
    /// Terrain around the buildings.
    Margin,
    /// Metres per vertical unit of the terrain.
    TerrainUnit,
    /// Height of a storey.
    StoreyHeight,
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Texel => "a texel",
            Self::TerrainError => "a terrain error",
            Self::DefaultHeight => "a default height",
            Self::Fill => "a hole width to fill",
            Self::Margin => "a margin",
            Self::TerrainUnit => "a terrain unit",
            Self::StoreyHeight => "a storey height",
        })
    }
}

/// Refuses numbers that no city can be made with.
pub fn check_numbers(options: &ImportOptions) -> Result<(), CityError> {
    let storey_height_m = match options.height_rule {
        Some(HeightRule::Storeys { storey_height_m, .. }) => storey_height_m,
        _ => options.storey_height_m,
    };
    for (setting, value, [min, max]) in [
        (Setting::Texel, options.texel_m, [0.1, 64.0]),
        (Setting::TerrainError, options.terrain_error_m, [0.001, 1000.0]),
        (Setting::DefaultHeight, options.default_height_m, [0.01, 2000.0]),
        (Setting::Fill, options.fill_m, [0.0, 500.0]),
        (Setting::Margin, options.margin_m, [0.0, 1_000_000.0]),
        (
            Setting::TerrainUnit,
            options.terrain_unit_m.unwrap_or(1.0),
            [0.001, 1000.0],
        ),
        (Setting::StoreyHeight, storey_height_m, [0.5, 50.0]),
    ] {
        if !(min..=max).contains(&value) {
            return Err(CityError::OutOfRange {
                setting,
                value,
                min,
                max,
            });
        }
    }
    Ok(())
}

/// The text that decides whether tiles of an earlier run can be kept, and the sources for the manifest.
pub struct CacheKey {
    /// Options, and what the sources' files hold.
    pub text: String,
    /// The sources.
    pub records: Vec<SourceRecord>,
    /// Size and time of each of their files.
    stamps: Vec<(PathBuf, Stamp)>,
}

/// Size and time.
type Stamp = Option<(u64, Option<SystemTime>)>;

fn stamp(file: &Path) -> Stamp {
    let data = std::fs::metadata(file).ok()?;
    Some((data.len(), data.modified().ok()))
}

/// The options, the facade rules, and size, time and digest of every file of every source: an import with the same cache key makes the
/// same tiles.
pub fn cache_key(options: &ImportOptions, rules: &str, sources: &SourceFiles) -> CacheKey {
    let (mut records, mut stamps) = (Vec::new(), Vec::new());
    let mut text = format!("rilievo {}\n", env!("CARGO_PKG_VERSION"));
    text += &format!("{options:?}\n{rules}");
    let roles = [
        (Layer::Terrain.name(), options.terrain.as_slice()),
        (Layer::Buildings.name(), std::slice::from_ref(&options.buildings)),
        (Layer::Imagery.name(), options.imagery.as_slice()),
        (PlanKind::Road.names(), options.plan.roads.as_slice()),
        (PlanKind::Rail.names(), options.plan.rails.as_slice()),
        (PlanKind::Water.names(), options.plan.water.as_slice()),
        (PlanKind::Green.names(), options.plan.green.as_slice()),
    ];
    for (role, path) in roles
        .iter()
        .flat_map(|(role, paths)| paths.iter().map(move |path| (role, path)))
    {
        let bytes = std::fs::metadata(path).map_or(0, |data| data.len());
        let files = sources.iter().find(|(known, _)| known == path);
        for file in files.into_iter().flat_map(|(_, files)| files) {
            let stamp = stamp(file);
            text += &format!("\n{role} {} {stamp:?} {:?}", file.display(), digest(file));
            stamps.push((file.clone(), stamp));
        }
        records.push(SourceRecord {
            role: (*role).to_owned(),
            path: path.display().to_string(),
            bytes,
        });
    }
    CacheKey {
        text,
        records,
        stamps,
    }
}

impl CacheKey {
    /// A file of the sources that was written since.
    pub fn changed_file(&self) -> Option<&Path> {
        let changed = self.stamps.iter().find(|(file, known)| stamp(file) != *known);
        changed.map(|(file, _)| file.as_path())
    }
}

/// Bytes up to which a file is digested whole; of a larger one as many, in pieces spread over it.
const DIGESTED: u64 = 64 << 20;
/// Bytes of such a piece.
const PIECE: u64 = 1 << 18;

/// Digest of what a file holds; none of what cannot be read.
fn digest(path: &Path) -> Option<u64> {
    let mut file = open_regular(path).ok()?;
    let size = file.metadata().ok().filter(|data| data.is_file())?.len();
    let pieces = size.min(DIGESTED).div_ceil(PIECE).max(1);
    let mut hasher = DefaultHasher::new();
    let mut piece = Vec::new();
    for k in 0..pieces {
        let start = size.saturating_sub(PIECE) * k / (pieces - 1).max(1);
        file.seek(SeekFrom::Start(start)).ok()?;
        piece.clear();
        Read::by_ref(&mut file).take(PIECE).read_to_end(&mut piece).ok()?;
        hasher.write(&piece);
    }
    Some(hasher.finish())
}
