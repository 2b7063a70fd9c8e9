//! `city.toml`: what the city is and where it came from.

use super::layer::Layer;
use serde::{Deserialize, Serialize};

use crate::source::{FootprintReport, HeightRule};
use crate::space::{Accuracy, Crs, Operation, Place, TileGrid};

/// Version of the folder's layout; a reader refuses others.
pub const FORMAT: u32 = 3;

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
