//! Imagery on the device.

use super::SceneError;
use crate::gpu::{Gpu, LayerPool};

/// Imagery of all resident tiles: a slot is a layer.
pub struct ImageryPool {
    /// A layer a tile, with mip levels.
    pub layers: LayerPool,
    /// Pixels along a tile's side, 0 in a city without imagery.
    pub side: u32,
}

impl ImageryPool {
    /// An empty pool of tiles of `side` pixels along a side.
    ///
    /// # Errors
    /// When the device cannot hold one.
    pub fn new(gpu: &Gpu, side: u32) -> Result<Self, SceneError> {
        let format = wgpu::TextureFormat::Rgba8UnormSrgb;
        let shown = side.max(1);
        Ok(Self {
            layers: LayerPool::new(gpu, "imagery", format, [shown; 2], shown.ilog2() + 1)?,
            side,
        })
    }

    /// Puts a tile's mip levels; its slot, and true when what shaders read was made anew.
    ///
    /// # Errors
    /// When the device holds no more.
    pub fn put(&mut self, gpu: &Gpu, mips: &[Vec<u8>]) -> Result<(u32, bool), SceneError> {
        let (layer, grows) = self.layers.take(gpu)?;
        for (level, texels) in (0..).zip(mips) {
            self.layers.write(gpu, layer, level, texels);
        }
        Ok((layer, grows))
    }

    /// Bytes of the tiles in it.
    pub fn bytes_used(&self) -> u64 {
        u64::from(self.layers.count()) * self.layers.image_bytes()
    }
}
