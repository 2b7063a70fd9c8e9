//! Which tiles are resident, and in which order they are drawn: the tile pool.
//!
//! ```text
//! view ─▶ level_of_detail ─▶ loader (city folder) ─▶ resident ─┬▶ map_pool, terrain_pool, imagery_pool (GPU) ─┐
//!                                                              └▶ tile_set (CPU: rays, picking) ──────────────┴▶ tile_table
//! ```

mod frustum;
mod error;
mod imagery_mips;
mod imagery_pool;
mod level_of_detail;
mod loader;
mod map_pool;
mod order;
mod resident;
mod site_coverage;
mod skirt;
mod terrain_pool;
mod tile_set;
mod tile_table;

pub use error::SceneError;
pub use frustum::Frustum;
pub use imagery_pool::ImageryPool;
pub use loader::stand_back;
pub use map_pool::{MapPool, POOL_QUADS, POOL_WORDS, RoofOutline, RoofRecord, TileRecord, VertexRecord};
pub use order::nearest_first;
pub use resident::{DEFAULT_BUDGET, PoolOptions, Resident};
pub use skirt::{SKIRT_BIT, SKIRT_M};
pub use terrain_pool::{GroundRecord, MeshIndices, TerrainMesh, TerrainPool, TerrainSlot};
pub use tile_set::{CityBounds, GroundTile, TileSet};
pub use tile_table::{TABLE_LEVEL_SHIFT, TileTable, level_and_slot};

/// Places of the layers in the tile table.
const MAPS: usize = 0;
const IMAGERY: usize = 1;
const TERRAIN: usize = 2;
/// After them: where the record of the building map lies.
const MAP_RECORD: usize = 3;
