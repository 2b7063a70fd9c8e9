//! `city.toml`: what the city is and where it came from.

use super::layer::Layer;
use serde::{Deserialize, Serialize};

use crate::buildings::BuildingMap;
use crate::source::{FootprintReport, HeightRule};
use crate::space::{Accuracy, Crs, Operation, Place, TileGrid};

/// Version of the folder's layout; a reader refuses others.
pub const FORMAT: u32 = 4;

/// The whole of `city.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Layout version.
    pub format: u32,
    /// Updates since the city was made.
    #[serde(default)]
    pub generation: u64,
    /// The city's name: the folder's.
    pub name: String,
    /// `EPSG:n`, or WKT where the CRS is not registered.
    pub crs: String,
    /// The unit of all lengths and heights.
    pub units: String,
    /// Side of a building-map texel, metres.
    pub texel_m: f64,
    /// Texels along a tile's side.
    pub tile_texels: usize,
    /// Distance between terrain samples, metres.
    pub terrain_step_m: f64,
    /// Terrain samples along a tile's side (both borders included).
    pub terrain_side: usize,
    /// Bound on the mesh's vertical error, metres.
    pub terrain_error_m: f64,
    /// Pixels along a orthophoto tile's side, 0 without orthophotos.
    #[serde(rename = "photo_side")]
    pub imagery_side: usize,
    /// Levels of the tile quadtree; one tile of the last covers the city.
    pub levels: u32,
    /// Terrain tiles on disk.
    pub terrain_tiles: u64,
    /// Building-map tiles on disk.
    pub building_tiles: u64,
    /// Imagery tiles on disk.
    #[serde(rename = "photo_tiles")]
    pub imagery_tiles: u64,
    /// Buildings in the footprint dataset.
    pub buildings: u64,
    /// How often the footprint dataset's file had been changed when the city was made (SQLite file format, 1.3.7).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dataset_changes: Option<u32>,
    /// Height of buildings without one, metres.
    pub default_height_m: f64,
    /// Triangles of the terrain's TIN, all tiles.
    pub terrain_triangles: u64,
    /// Triangles of the regular grid, all tiles.
    pub grid_triangles: u64,
    /// Bytes of the building map when loaded, pyramid included.
    pub building_map_bytes: u64,
    /// Bytes of the same buildings as walls and roofs of indexed triangles.
    pub triangle_bytes: u64,
    /// Where on the globe the centre of the city is.
    pub place: Place,
    /// The tile grid.
    pub grid: TileGrid,
    /// Which attribute gives heights.
    pub height_rule: HeightRule,
    /// The files it was made from.
    pub sources: Vec<SourceRecord>,
    /// How the sources' coordinates came into the city's CRS; empty in cities of older versions.
    #[serde(default)]
    pub operations: Vec<OperationRecord>,
    /// What became of the footprints.
    pub footprints: FootprintReport,
}

/// Most terrain samples and imagery pixels along a tile's side: what an import makes at most.
const MAX_TERRAIN_SIDE: usize = 1025;
pub const MAX_IMAGERY_SIDE: usize = 1024;
/// Fewest texels along a tile's side: a group of blocks.
const MIN_TILE_TEXELS: usize = 16;
/// Most tiles of a city's finest level.
pub const MAX_TILES: u64 = 1_000_000;
/// Most updates of a city.
pub const MAX_GENERATION: u64 = 1 << 48;
/// Most bytes of a building map that a manifest may tell of.
const MAX_MAP_BYTES: u64 = 1 << 42;

impl Manifest {
    /// Reads the text of a `city.toml`; what it asks a reader for is bounded.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let manifest: Self =
            toml::from_str(text).map_err(|error| format!("city.toml: {}", error.message()))?;
        if manifest.format != FORMAT {
            return Err(format!(
                "its format is {}, this program reads {FORMAT}: import it again",
                manifest.format
            ));
        }
        if !manifest.is_sane() {
            return Err("city.toml: its sizes are impossible".to_owned());
        }
        if !text
            .parse()
            .map(toml::Value::Table)
            .as_ref()
            .is_ok_and(is_printable)
        {
            return Err("city.toml: has control characters, which a terminal would obey".to_owned());
        }
        if !Crs::is_plain_definition(&manifest.crs) {
            return Err("city.toml: its CRS is neither a code such as EPSG:25832 nor WKT".to_owned());
        }
        Ok(manifest)
    }

    /// Whether all sizes are such as an import makes.
    fn is_sane(&self) -> bool {
        let grid = &self.grid;
        let tiles = u64::from(grid.columns) * u64::from(grid.rows);
        self.tile_texels.is_power_of_two()
            && (2..=MAX_TERRAIN_SIDE).contains(&self.terrain_side)
            && self.imagery_side <= MAX_IMAGERY_SIDE
            && (MIN_TILE_TEXELS..=BuildingMap::MAX_SIDE).contains(&self.tile_texels)
            && [grid.west, grid.south].iter().all(|edge| edge.abs() < 1e9)
            && (0.01..=1e4).contains(&self.texel_m)
            && (self.texel_m * self.tile_texels as f64 / grid.tile_m - 1.0).abs() < 1e-6
            && (self.terrain_step_m * (self.terrain_side - 1) as f64 / grid.tile_m - 1.0).abs() < 1e-6
            && (-90.0..=90.0).contains(&self.place.latitude_deg)
            && (-360.0..=360.0).contains(&self.place.longitude_deg)
            && (1..=MAX_TILES).contains(&tiles)
            && [self.terrain_tiles, self.building_tiles, self.imagery_tiles]
                .iter()
                .all(|&count| count <= tiles)
            && self.terrain_tiles > 0
            && self.generation <= MAX_GENERATION
            // A city of many places and hardly a tile is none.
            && tiles <= 64 + 4096 * self.terrain_tiles
            && self.building_map_bytes <= MAX_MAP_BYTES
            && self.triangle_bytes <= MAX_MAP_BYTES
            && (1e-6..=1e6).contains(&self.terrain_error_m)
            && (0.0..=1e5).contains(&self.default_height_m)
            && self.levels == grid.levels()
    }
}

/// Whether all texts of a value can be shown as they are.
fn is_printable(value: &toml::Value) -> bool {
    let plain = |text: &str| !text.contains(|c: char| c.is_control() && !['\n', '\t'].contains(&c));
    match value {
        toml::Value::String(text) => plain(text),
        toml::Value::Array(values) => values.iter().all(is_printable),
        toml::Value::Table(table) => table.iter().all(|(key, value)| plain(key) && is_printable(value)),
        _ => true,
    }
}

/// One source file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SourceRecord {
    /// The layer made of it: `terrain`, `buildings` or `photo`.
    pub role: String,
    /// File name as given.
    pub path: String,
    /// Bytes.
    pub bytes: u64,
}

/// The coordinate operation of one kind of source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OperationRecord {
    /// `terrain`, `buildings` or `photo`.
    pub role: String,
    /// CRS of the source: `EPSG:n` or WKT.
    pub from: String,
    /// The operation in PROJ's words, `none` where the source is in the city's CRS.
    pub operation: String,
    /// How far it may be off, metres: 0 is exact, absent is unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy_m: Option<f64>,
    /// True when one datum was taken for another, for want of a known shift.
    pub ballpark: bool,
}

impl OperationRecord {
    /// Of an operation from a source's CRS; none where it is the city's.
    pub fn new(role: &str, from: &Crs, operation: Option<&Operation>) -> Self {
        let accuracy = operation.map_or(Accuracy::Metres(0.0), |operation| operation.accuracy);
        Self {
            role: role.to_owned(),
            from: from.label().to_owned(),
            operation: operation.map_or("none".to_owned(), |operation| operation.name.clone()),
            accuracy_m: accuracy.metres(),
            ballpark: accuracy == Accuracy::Ballpark,
        }
    }

    /// Its accuracy as a value.
    pub fn accuracy(&self) -> Accuracy {
        match self.accuracy_m {
            _ if self.ballpark => Accuracy::Ballpark,
            Some(metres) => Accuracy::Metres(metres),
            None => Accuracy::Unknown,
        }
    }
}

impl Manifest {
    /// Tiles of a layer.
    pub fn tile_count(&self, layer: Layer) -> u64 {
        match layer {
            Layer::Terrain => self.terrain_tiles,
            Layer::Buildings => self.building_tiles,
            Layer::Imagery => self.imagery_tiles,
        }
    }
}
