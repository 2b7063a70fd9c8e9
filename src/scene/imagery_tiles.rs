//! Imagery tiles on the GPU.

use super::SceneError;
use super::imagery_mips::imagery_mips;
use crate::city::ImageryTile;
use crate::gpu::{Gpu, TextureArray};

/// Most bytes of imagery resident; larger cities drop the finest mip levels.
const MAX_BYTES: u64 = 1 << 30;

/// Imagery on its way to the GPU.
pub struct ImageryTiles {
    /// A layer a tile, with mip levels.
    pub array: TextureArray,
    /// Pixels along a tile's side as resident.
    pub side: u32,
    /// Bytes on the GPU.
    pub bytes: u64,
    /// Finest levels that are left out.
    dropped_levels: usize,
    layers: u32,
}

impl ImageryTiles {
    /// Room for `layers` tiles of `full_side` pixels along a side.
    pub fn new(gpu: &Gpu, full_side: u32, layers: u32) -> Result<Self, SceneError> {
        // A third more for the mip levels.
        let bytes_at = |side: u32| u64::from(side) * u64::from(side) * 16 / 3 * u64::from(layers);
        let mut dropped = 0;
        while bytes_at(full_side >> dropped) > MAX_BYTES {
            dropped += 1;
        }
        let side = (full_side >> dropped).max(1);
        let format = wgpu::TextureFormat::Rgba8UnormSrgb;
        Ok(Self {
            array: TextureArray::new(gpu, "imagery", format, [side; 2], [side.ilog2() + 1, layers])?,
            side,
            bytes: bytes_at(side),
            dropped_levels: dropped as usize,
            layers: 0,
        })
    }

    /// Uploads one tile; its layer.
    pub fn put(&mut self, gpu: &Gpu, imagery: ImageryTile) -> u32 {
        let layer = self.layers;
        let mips = imagery_mips(imagery.rgba, imagery.side);
        for (level, texels) in (0..).zip(mips.iter().skip(self.dropped_levels)) {
            self.array.write(gpu, layer, level, texels);
        }
        self.layers += 1;
        layer
    }
}
