//! Facades and roofs: rules say which a building has, painters make the tiled textures of each, an array of them goes to the device.
//!
//! ```text
//! traits, height, area ─▶ facade_rules ─▶ building_material (a code in the building map)
//! facade_style, roof_style ─▶ facade_painter, roof_painter, ground_painter | own_facade (pictures) ─▶ textures
//! ```

mod brickwork;
mod building_material;
mod canvas;
mod facade_painter;
mod facade_rules;
mod facade_style;
mod ground_painter;
mod noise;
mod openings;
mod own_facade;
mod roof_painter;
mod textures;

pub use building_material::{BuildingMaterial, Facade};
pub use canvas::{Canvas, MAX_SLOPE, TILE_SIZE, TileLevel, WALL_GREY};
pub use facade_painter::{FacadeBand, paint_facade};
pub use facade_rules::{FacadeRules, RulesError};
pub use facade_style::{FacadeStyle, RoofStyle};
pub use ground_painter::paint_ground;
pub use own_facade::{MAX_OWN_FACADES, OwnFacade, facade_from_picture};
pub use roof_painter::{ROOF_M, paint_roof};
pub use textures::{FACADE_LAYERS, GROUND_LAYER, MaterialTextures, OWN_LAYERS, OwnTiles, painted_tiles};
