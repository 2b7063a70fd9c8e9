//! How much of a city is held on the device.

use std::io::Write;

use crate::output::Renderer;
use crate::scene::{PoolOptions, TerrainMesh};

/// Flags of the tile pool.
#[derive(Debug, clap::Args)]
pub struct PoolFlags {
    /// Tiles on the device, megabytes; a city that is larger is shown coarser far away.
    #[arg(long, default_value_t = 1000, value_name = "MB", value_parser = clap::value_parser!(u64).range(16..=1_000_000))]
    memory: u64,
}

impl PoolFlags {
    /// The pool's options.
    pub fn options(&self, mesh: TerrainMesh) -> PoolOptions {
        PoolOptions {
            mesh,
            budget: 1_000_000 * self.memory,
            ..PoolOptions::default()
        }
    }
}

/// Tells on standard error what there is to say of the tiles.
pub fn tell_warnings(renderer: &mut Renderer) {
    for warning in renderer.resident.take_warnings() {
        // Nothing else can be done when standard error is closed.
        let _ = writeln!(std::io::stderr(), "rilievo: {warning}");
    }
}
