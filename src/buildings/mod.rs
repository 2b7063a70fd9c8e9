//! The building map: footprints rasterised per tile, with the exact outline list in every texel an outline
//! crosses. Change a footprint and only its texels change.

mod building;
mod cell;
mod coarser;
mod device_map;
mod facade_coordinates;
mod footprint_mask;
mod map;
mod map_tile;
mod pyramid;
mod rasterise;
mod sound;

pub use building::{Building, NoGround, base_of, triangle_bytes};
pub use cell::{CELL, CellFields, CellKind, Full, Run};
pub use coarser::{coarser, coarser_updated};
pub use device_map::DeviceMap;
pub use facade_coordinates::facade_coordinates;
pub use footprint_mask::FootprintMask;
pub use map::{BLOCK, Block, BuildingMap, OutlineVertex, RoofRecord, TEXEL_MAIN};
pub use map_tile::MapTile;
pub use pyramid::{Pyramid, STEPS as PYRAMID_STEPS};
pub use rasterise::{MapTooLarge, rasterise};
