//! What the relief's shaders share with Rust: the prelude of every one of them.

use super::search_parameters::SEARCH_BAY_M;
use super::settings::Layers;
use super::streets::{CARRIAGEWAY_M, CARRIAGEWAY_PART, STREET_BORDER_M, STREET_CELLS};
use super::sun_bounds::{SUN_BORDER, SUN_CELLS, SUN_STEPS};
use crate::buildings::{BuildingMap, CELL, PYRAMID_STEPS, TEXEL_MAIN};
use crate::gpu::{Constant, ConstantValue};
use crate::material::{
    FACADE_LAYERS, FacadeBand, FacadeStyle, GROUND_LAYER, MAX_SLOPE, OWN_LAYERS, ROOF_M, RoofStyle,
    TILE_SIZE, WALL_GREY,
};
use crate::scene::{POOL_QUADS, POOL_WORDS, SKIRT_BIT, SKIRT_M, TABLE_LEVEL_SHIFT};
use crate::space::atmosphere::{HAZE_PER_KM, MIE_G};
use crate::terrain::GroundBounds;

/// Metres along a ray that meets nothing.
pub const FAR: f32 = 3.0e38;
/// Side of the block of pixels that a cone goes round.
pub const CONE_PIXELS: u32 = 8;
/// More steps than any walk needs; a guard against endless loops, not a limit on quality.
pub const MAX_STEPS: u32 = 8192;
/// Rounding of a hit's position along the ray: metres, and metres a metre.
pub const SLACK: [f32; 2] = [1e-3, 2e-6];

/// Name and value of each.
pub const CONSTANTS: &[Constant] = &[
    ("FAR", ConstantValue::Float(FAR)),
    ("CONE_PIXELS", ConstantValue::Int(CONE_PIXELS as i32)),
    ("MAX_STEPS", ConstantValue::Uint(MAX_STEPS)),
    ("SLACK", ConstantValue::Float2(SLACK)),
    ("REFERENCE", ConstantValue::Float2(BuildingMap::REFERENCE)),
    ("PYRAMID_STEPS", ConstantValue::Float(PYRAMID_STEPS)),
    ("KIND_SHIFT", ConstantValue::Uint(CELL.kind_shift)),
    ("KIND_RUN", ConstantValue::Uint(CELL.run)),
    ("KIND_LIST", ConstantValue::Uint(CELL.list)),
    ("INSIDE_BIT", ConstantValue::Uint(CELL.inside_bit)),
    ("MORE_BIT", ConstantValue::Uint(CELL.more_bit)),
    ("EDGES_SHIFT", ConstantValue::Uint(CELL.edges_shift)),
    ("EDGES_MASK", ConstantValue::Uint(CELL.edges_mask)),
    ("INDEX_MASK", ConstantValue::Uint(CELL.index_mask)),
    ("TEXEL_MAIN", ConstantValue::Uint(TEXEL_MAIN)),
    ("POOL_WORDS", ConstantValue::Uint(POOL_WORDS)),
    ("POOL_QUADS", ConstantValue::Uint(POOL_QUADS)),
    ("TABLE_LEVEL_SHIFT", ConstantValue::Uint(TABLE_LEVEL_SHIFT)),
    ("SKIRT_BIT", ConstantValue::Uint(SKIRT_BIT)),
    ("SKIRT_M", ConstantValue::Float(SKIRT_M)),
    ("GROUND_BLOCKS", ConstantValue::Int(GroundBounds::BLOCKS as i32)),
    ("FACADE_BANDS", ConstantValue::Uint(FacadeBand::ALL.len() as u32)),
    ("FACADE_LAYERS", ConstantValue::Uint(FACADE_LAYERS)),
    ("GROUND_LAYER", ConstantValue::Uint(GROUND_LAYER)),
    ("OWN_LAYERS", ConstantValue::Uint(OWN_LAYERS)),
    ("FACADES", ConstantValue::Uint(FacadeStyle::ALL.len() as u32)),
    ("GRAVEL", ConstantValue::Uint(RoofStyle::Gravel as u32)),
    ("TILES", ConstantValue::Uint(RoofStyle::Tiles as u32)),
    ("SLATE", ConstantValue::Uint(RoofStyle::Slate as u32)),
    ("MEMBRANE", ConstantValue::Uint(RoofStyle::Membrane as u32)),
    ("ROOF_M", ConstantValue::Float2(ROOF_M)),
    (
        "TILE_SIZE",
        ConstantValue::Float2([TILE_SIZE[0] as f32, TILE_SIZE[1] as f32]),
    ),
    ("WALL_GREY", ConstantValue::Float(WALL_GREY)),
    ("MAX_SLOPE", ConstantValue::Float(MAX_SLOPE)),
    ("SEARCH_BAY_M", ConstantValue::Float(SEARCH_BAY_M)),
    ("MIE_G", ConstantValue::Float(MIE_G as f32)),
    ("HAZE_PER_M", ConstantValue::Float((1.0e-3 * HAZE_PER_KM) as f32)),
    ("SUN_CELLS", ConstantValue::Int(SUN_CELLS as i32)),
    ("SUN_BORDER", ConstantValue::Float(SUN_BORDER as f32)),
    ("CARRIAGEWAY_PART", ConstantValue::Float(CARRIAGEWAY_PART)),
    ("CARRIAGEWAY_M", ConstantValue::Float(CARRIAGEWAY_M)),
    ("STREET_CELLS", ConstantValue::Int(STREET_CELLS as i32)),
    ("STREET_BORDER_M", ConstantValue::Float(STREET_BORDER_M as f32)),
    ("SUN_STEPS", ConstantValue::Float4(SUN_STEPS)),
    ("HIDES_BUILDINGS", ConstantValue::Uint(Layers::HIDDEN_BITS[0])),
    ("HIDES_FACADES", ConstantValue::Uint(Layers::HIDDEN_BITS[1])),
    ("HIDES_IMAGERY", ConstantValue::Uint(Layers::HIDDEN_BITS[2])),
    ("GROUND_LEVELS", ConstantValue::Uint(GroundBounds::LEVELS)),
];
