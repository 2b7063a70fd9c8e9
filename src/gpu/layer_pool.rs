//! Room for many images of one size in one array texture that grows: a layer an image.

use super::upload::tile_texture;
use super::{Gpu, GpuError};

/// An array texture and its free layers.
pub struct LayerPool {
    label: &'static str,
    format: wgpu::TextureFormat,
    size: [u32; 2],
    levels: u32,
    texture: wgpu::Texture,
    /// View of all layers and levels.
    pub view: wgpu::TextureView,
    /// Layers given back, the last the next to be used.
    free: Vec<u32>,
    /// Layers ever used.
    used: u32,
}

impl LayerPool {
    /// An empty pool of images of `size` texels with `levels` mip levels.
    ///
    /// # Errors
    /// When the device has no texture so large.
    pub fn new(
        gpu: &Gpu,
        label: &'static str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        levels: u32,
    ) -> Result<Self, GpuError> {
        let allowed = gpu.device.limits().max_texture_dimension_2d;
        gpu.require(label, u64::from(size[0].max(size[1])), u64::from(allowed))?;
        let (texture, view) = make(gpu, (label, format), size, [levels, 1]);
        Ok(Self {
            label,
            format,
            size,
            levels,
            texture,
            view,
            free: Vec::new(),
            used: 0,
        })
    }

    /// Most images that the device can hold.
    pub fn capacity(gpu: &Gpu) -> u32 {
        gpu.device.limits().max_texture_array_layers
    }

    /// Bytes of an image.
    pub fn image_bytes(&self) -> u64 {
        let texel = u64::from(self.format.block_copy_size(None).unwrap_or(1));
        let texels = |level: u32| {
            self.size
                .map(|side| u64::from((side >> level).max(1)))
                .iter()
                .product::<u64>()
        };
        (0..self.levels).map(texels).sum::<u64>() * texel
    }

    /// Images in it.
    pub fn count(&self) -> u32 {
        self.used - self.free.len() as u32
    }

    /// A layer for an image; true beside it when the texture was made anew for it.
    ///
    /// # Errors
    /// When the device allows no more layers.
    pub fn take(&mut self, gpu: &Gpu) -> Result<(u32, bool), GpuError> {
        if let Some(layer) = self.free.pop() {
            return Ok((layer, false));
        }
        let grows = self.used == self.texture.depth_or_array_layers();
        if grows {
            self.grow_to(gpu, self.used + self.used / 8 + 1)?;
        }
        self.used += 1;
        Ok((self.used - 1, grows))
    }

    /// Makes room for more images at once; true when the texture was made anew.
    ///
    /// # Errors
    /// When the device allows no more layers.
    pub fn reserve(&mut self, gpu: &Gpu, images: u32) -> Result<bool, GpuError> {
        let wanted = (self.count() + images).min(Self::capacity(gpu));
        let grows = wanted > self.texture.depth_or_array_layers();
        if grows {
            self.grow_to(gpu, wanted)?;
        }
        Ok(grows)
    }

    /// Gives a layer back.
    pub fn free(&mut self, layer: u32) {
        self.free.push(layer);
    }

    fn grow_to(&mut self, gpu: &Gpu, layers: u32) -> Result<(), GpuError> {
        let allowed = Self::capacity(gpu);
        gpu.require(self.label, u64::from(self.used) + 1, u64::from(allowed))?;
        let layers = layers.min(allowed);
        let (texture, view) = make(gpu, (self.label, self.format), self.size, [self.levels, layers]);
        if self.used > 0 {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            for level in 0..self.levels {
                let place = |texture| wgpu::TexelCopyTextureInfo {
                    texture,
                    mip_level: level,
                    origin: wgpu::Origin3d::ZERO,
                    aspect: wgpu::TextureAspect::All,
                };
                let [width, height] = self.size.map(|side| (side >> level).max(1));
                let size = wgpu::Extent3d {
                    width,
                    height,
                    depth_or_array_layers: self.used,
                };
                encoder.copy_texture_to_texture(place(&self.texture), place(&texture), size);
            }
            gpu.queue.submit([encoder.finish()]);
        }
        (self.texture, self.view) = (texture, view);
        Ok(())
    }

    /// Writes one mip level of one layer.
    pub fn write<T: bytemuck::NoUninit>(&self, gpu: &Gpu, layer: u32, level: u32, texels: &[T]) {
        let [width, height] = self.size.map(|side| (side >> level).max(1));
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &self.texture,
                mip_level: level,
                origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(size_of_val(texels) as u32 / height),
                rows_per_image: Some(height),
            },
            wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
        );
    }
}

fn make(
    gpu: &Gpu,
    (label, format): (&str, wgpu::TextureFormat),
    size: [u32; 2],
    levels_and_layers: [u32; 2],
) -> (wgpu::Texture, wgpu::TextureView) {
    let texture = tile_texture(gpu, label, size, levels_and_layers, format);
    let view = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    (texture, view)
}
