//! The layers of the tile grid: the one place that knows their folders.

use std::path::{Path, PathBuf};

use crate::space::TileId;

/// A layer of the tile grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Ground heights.
    Terrain,
    /// Building map.
    Buildings,
    /// Orthophotos.
    Imagery,
}

impl Layer {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Terrain, Self::Buildings, Self::Imagery];

    /// Its folder in a city folder, and the role of its sources in the manifest.
    pub fn name(self) -> &'static str {
        match self {
            Self::Terrain => "terrain",
            Self::Buildings => "buildings",
            Self::Imagery => "photo",
        }
    }

    /// Where the errors of the terrain's coarse levels lie under a city folder.
    pub fn errors_path(self, folder: &Path) -> PathBuf {
        folder.join(self.name()).join("errors.tif")
    }

    /// Where a level's files lie under a city folder.
    pub fn level_path(self, folder: &Path, level: u32) -> PathBuf {
        folder.join(self.name()).join(level.to_string())
    }

    /// Where a tile's file lies under a city folder.
    pub fn tile_path(self, folder: &Path, tile: TileId) -> PathBuf {
        self.level_path(folder, tile.level)
            .join(format!("{}_{}.tif", tile.x, tile.y))
    }
}
