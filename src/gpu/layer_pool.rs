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
    /// A larger texture that is being made.
    growth: Option<Growth>,
}

/// A larger texture, and how many of its layers hold something.
struct Growth {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    filled: u32,
}

/// Bytes that a growth in parts copies at a time: a few milliseconds of a software device.
const PART_BYTES: u64 = 16 << 20;
/// Layers that it makes room for at least.
const MIN_GROWN: u32 = 8;
/// Bytes that are made at once nevertheless, where a part holds all that there is: as a city is opened.
const AT_ONCE_BYTES: u64 = 4 * PART_BYTES;

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
            growth: None,
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

    /// The same while frames go on: where that is much work, a part of it at a time, and room for half as many more at a time. True when
    /// the texture was made anew.
    ///
    /// # Errors
    /// When the device allows no more layers.
    pub fn grow_a_part(&mut self, gpu: &Gpu, images: u32) -> Result<bool, GpuError> {
        let layers = self.texture.depth_or_array_layers();
        let wanted = self.count() + images;
        // What was begun is finished: what is wanted comes and goes from frame to frame.
        if self.growth.is_none() && wanted.min(Self::capacity(gpu)) <= layers {
            return Ok(false);
        }
        // Somewhat more: the next view wants a few others.
        let roomy = (wanted + wanted / 8).min(Self::capacity(gpu));
        let bytes = |layers: u32| u64::from(layers) * self.image_bytes();
        if self.growth.is_none() && bytes(self.used) <= PART_BYTES && bytes(roomy) <= AT_ONCE_BYTES {
            self.grow_to(gpu, roomy)?;
            return Ok(true);
        }
        let wanted = roomy.min((layers + layers / 2).max(MIN_GROWN));
        let mut growth = self.growth.take().unwrap_or_else(|| {
            let (texture, view) = make(gpu, (self.label, self.format), self.size, [self.levels, wanted]);
            Growth {
                texture,
                view,
                filled: 0,
            }
        });
        let all = growth.texture.depth_or_array_layers();
        let part = u32::try_from(PART_BYTES / self.image_bytes().max(1)).unwrap_or(all);
        let filled = (growth.filled + part.max(1)).min(all);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for layer in growth.filled..filled {
            // What holds nothing yet is filled too: else the device would clear it all at once when it is first seen.
            let from = if layer < self.used { layer } else { 0 };
            self.copy(&mut encoder, &growth.texture, [from, layer], 1);
        }
        gpu.queue.submit([encoder.finish()]);
        growth.filled = filled;
        if filled < all {
            self.growth = Some(growth);
            return Ok(false);
        }
        (self.texture, self.view) = (growth.texture, growth.view);
        Ok(true)
    }

    /// Images that may come: as many as there is room for, any number where it can become no more, as others have to go then.
    pub fn room(&self, gpu: &Gpu) -> u32 {
        match self.texture.depth_or_array_layers() {
            layers if layers >= Self::capacity(gpu) => layers,
            layers => layers - self.count(),
        }
    }

    /// Whether it is growing, a part at a time.
    pub fn is_growing(&self) -> bool {
        self.growth.is_some()
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
            self.copy(&mut encoder, &texture, [0; 2], self.used);
            gpu.queue.submit([encoder.finish()]);
        }
        self.growth = None;
        (self.texture, self.view) = (texture, view);
        Ok(())
    }

    /// Copies layers, all their levels, into another texture: from the first number, to the second.
    fn copy(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        onto: &wgpu::Texture,
        [from, to]: [u32; 2],
        layers: u32,
    ) {
        for level in 0..self.levels {
            encoder.copy_texture_to_texture(
                place(&self.texture, level, from),
                place(onto, level, to),
                self.extent(level, layers),
            );
        }
    }

    fn extent(&self, level: u32, layers: u32) -> wgpu::Extent3d {
        let [width, height] = self.size.map(|side| (side >> level).max(1));
        wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: layers,
        }
    }

    /// Writes one mip level of one layer.
    pub fn write<T: bytemuck::NoUninit>(&self, gpu: &Gpu, layer: u32, level: u32, texels: &[T]) {
        let extent = self.extent(level, 1);
        // Into what grows as well, where the layer was copied already.
        let grown = self.growth.as_ref().filter(|growth| layer < growth.filled);
        for texture in [Some(&self.texture), grown.map(|growth| &growth.texture)]
            .into_iter()
            .flatten()
        {
            gpu.queue.write_texture(
                place(texture, level, layer),
                bytemuck::cast_slice(texels),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(size_of_val(texels) as u32 / extent.height),
                    rows_per_image: Some(extent.height),
                },
                extent,
            );
        }
    }
}

fn place(texture: &wgpu::Texture, level: u32, layer: u32) -> wgpu::TexelCopyTextureInfo<'_> {
    wgpu::TexelCopyTextureInfo {
        texture,
        mip_level: level,
        origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
        aspect: wgpu::TextureAspect::All,
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::gpu::read_texture;

    /// The value of all texels of a layer.
    fn held(gpu: &Gpu, pool: &LayerPool, layer: u32, level: u32) -> u32 {
        let extent = pool.extent(level, 1);
        let (texture, _) = make(gpu, ("layer", pool.format), [extent.width, extent.height], [1, 1]);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let from = place(&pool.texture, level, layer);
        encoder.copy_texture_to_texture(from, place(&texture, 0, 0), extent);
        gpu.queue.submit([encoder.finish()]);
        let texels = read_texture::<u32>(gpu, &texture).unwrap();
        assert!(texels.iter().all(|&texel| texel == texels[0]));
        texels[0]
    }

    #[test]
    fn a_pool_that_grows_a_part_at_a_time_keeps_its_images_and_those_that_change() {
        let gpu = Gpu::open().unwrap();
        let size = [1024, 1024];
        let format = wgpu::TextureFormat::R32Uint;
        let mut pool = LayerPool::new(&gpu, "test", format, size, 2).unwrap();
        let put = |pool: &LayerPool, layer: u32, value: u32| {
            pool.write(&gpu, layer, 0, &vec![value; 1 << 20]);
            pool.write(&gpu, layer, 1, &vec![value + 1; 1 << 18]);
        };
        let (first, _) = pool.take(&gpu).unwrap();
        put(&pool, first, 10);
        assert_eq!(pool.room(&gpu), 0);
        assert!(!pool.grow_a_part(&gpu, 20).unwrap(), "in one part");
        assert!(pool.is_growing());
        put(&pool, first, 20);
        let mut parts = 1;
        // What is wanted changes meanwhile.
        while !pool.grow_a_part(&gpu, 20 + parts % 3 * 5).unwrap() {
            parts += 1;
            assert!(parts < 100);
        }
        assert!(parts > 1 && !pool.is_growing());
        assert!(pool.room(&gpu) >= 7, "{}", pool.room(&gpu));
        let layers: Vec<u32> = (0..3)
            .map(|k| {
                let (layer, grows) = pool.take(&gpu).unwrap();
                assert!(!grows);
                put(&pool, layer, 30 + 10 * k);
                layer
            })
            .collect();
        assert_eq!(
            [held(&gpu, &pool, first, 0), held(&gpu, &pool, first, 1)],
            [20, 21]
        );
        for (k, layer) in (0..).zip(layers) {
            assert_eq!(held(&gpu, &pool, layer, 0), 30 + 10 * k);
        }
        // There is room: nothing grows.
        assert!(!pool.grow_a_part(&gpu, 1).unwrap() && !pool.is_growing());
    }
}
