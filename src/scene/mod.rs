//! Which tiles are resident, and in which order they are drawn. For now every tile of level 0 is; streaming and levels have
//! their place here.
//!
//! ```text
//! city ─▶ Tile ─┬▶ ground_tiles, map_tiles, imagery_tiles (GPU) ─┐
//!               └▶ tile_set (CPU: rays, picking) ────────────────┴▶ Resident
//! ```

mod frustum;
mod error;
mod ground_tiles;
mod imagery_mips;
mod imagery_tiles;
mod map_tiles;
mod order;
mod resident;
mod tile_set;

pub use error::SceneError;
pub use frustum::Frustum;
pub use ground_tiles::{GroundRecord, GroundSlot, GroundTiles, TerrainMesh};
pub use imagery_tiles::ImageryTiles;
pub use map_tiles::{MapTiles, TileRecord, VertexRecord};
pub use order::nearest_first;
pub use resident::Resident;
pub use tile_set::{GroundTile, TileSet, WalkTile};
