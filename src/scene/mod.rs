//! Which tiles are on the GPU, and in which order they are drawn. For now every tile of level 0 is resident;
//! streaming and levels have their place here.

mod batch;
mod cull;
mod error;
mod ground;
mod maps;
mod order;
mod imagery_mips;
mod imagery;
mod resident;

pub use cull::Frustum;
pub use error::SceneError;
pub use ground::{GroundSlot, GroundTile, TerrainMesh};
pub use maps::{Corner, TileSlot};
pub use order::nearest_first;
pub use resident::Resident;
