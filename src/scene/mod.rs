//! Which tiles are on the GPU, and in which order they are drawn. For now every tile of level 0 is resident;
//! streaming and levels have their place here.

mod cull;
mod order;
mod photo_mips;
mod resident;

pub use cull::Frustum;
pub use order::nearest_first;
pub use resident::{GroundSlot, GroundTile, Resident, SceneError, TerrainMesh, TileSlot};
