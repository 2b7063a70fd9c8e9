//! Room for many runs of texels in one texture that grows: a texture of one row after the other, because a software device gathers
//! from textures for all lanes at once, from buffers lane by lane.

use offset_allocator::{Allocation, Allocator};

use super::upload::tile_texture;
use super::{Gpu, GpuError};

/// Texels that are handed out together.
const PAGE: u32 = 64;

/// A run of texels.
#[derive(Clone, Copy)]
pub struct TexelRun {
    /// Its first texel.
    pub first: u32,
    pages: u32,
    allocation: Allocation,
}

/// A texture of runs.
pub struct TexelPool {
    label: &'static str,
    format: wgpu::TextureFormat,
    /// Texels along a row.
    width: u32,
    texture: wgpu::Texture,
    /// What shaders read.
    pub view: wgpu::TextureView,
    allocator: Allocator,
    pages_used: u32,
}

impl TexelPool {
    /// An empty pool with rows of `width` texels, a multiple of the page.
    ///
    /// # Errors
    /// When the device has no texture so wide.
    pub fn new(
        gpu: &Gpu,
        label: &'static str,
        format: wgpu::TextureFormat,
        width: u32,
    ) -> Result<Self, GpuError> {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        gpu.require(label, u64::from(width), u64::from(limit))?;
        let (texture, view) = make(gpu, label, format, [width, 1]);
        Ok(Self {
            label,
            format,
            width,
            texture,
            view,
            allocator: Allocator::new((width / PAGE).saturating_mul(limit)),
            pages_used: 0,
        })
    }

    fn texel_bytes(&self) -> u64 {
        u64::from(self.format.block_copy_size(None).unwrap_or(1))
    }

    /// Bytes of the texture.
    pub fn bytes(&self) -> u64 {
        u64::from(self.width) * u64::from(self.texture.height()) * self.texel_bytes()
    }

    /// Bytes of the runs in use.
    pub fn bytes_used(&self) -> u64 {
        u64::from(self.pages_used) * u64::from(PAGE) * self.texel_bytes()
    }

    /// Writes a run; true beside it when the texture was made anew for it.
    ///
    /// # Errors
    /// When the largest texture of the device is full.
    pub fn put<T: bytemuck::NoUninit>(
        &mut self,
        gpu: &Gpu,
        texels: &[T],
    ) -> Result<(TexelRun, bool), GpuError> {
        let (run, grows) = self.take(gpu, texels.len() as u32)?;
        self.fill(gpu, &run, texels);
        Ok((run, grows))
    }

    /// Writes what a run holds.
    pub fn fill<T: bytemuck::NoUninit>(&self, gpu: &Gpu, run: &TexelRun, texels: &[T]) {
        self.write(gpu, run.first, bytemuck::cast_slice(texels));
    }

    /// Takes a run of some texels, to be filled; true beside it when the texture was made anew for it.
    ///
    /// # Errors
    /// When the largest texture of the device is full.
    pub fn take(&mut self, gpu: &Gpu, texels: u32) -> Result<(TexelRun, bool), GpuError> {
        let pages = texels.div_ceil(PAGE).max(1);
        let limit = u64::from(gpu.device.limits().max_texture_dimension_2d) * u64::from(self.width);
        let full = |this: &Self| gpu.require(this.label, limit + 1, limit);
        let Some(allocation) = self.allocator.allocate(pages) else {
            full(self)?;
            return Err(gpu.failed(self.label));
        };
        let run = TexelRun {
            first: allocation.offset * PAGE,
            pages,
            allocation,
        };
        self.pages_used += pages;
        let rows = (run.first + pages * PAGE).div_ceil(self.width);
        let grows = rows > self.texture.height();
        if grows {
            self.reserve_rows(gpu, rows + rows / 8);
        }
        Ok((run, grows))
    }

    /// Makes room for more texels at once, so that the texture need not grow for each run; true when it was made anew.
    pub fn reserve(&mut self, gpu: &Gpu, texels: u64) -> bool {
        let used = u64::from(self.pages_used) * u64::from(PAGE);
        let limit = u64::from(gpu.device.limits().max_texture_dimension_2d);
        let rows = (used + texels).div_ceil(u64::from(self.width)).min(limit) as u32;
        let grows = rows > self.texture.height();
        if grows {
            // Some more: runs are rounded to pages, and sizes are estimates.
            self.reserve_rows(gpu, rows + rows / 8);
        }
        grows
    }

    /// Gives a run back.
    pub fn free(&mut self, run: TexelRun) {
        self.pages_used -= run.pages;
        self.allocator.free(run.allocation);
    }

    fn reserve_rows(&mut self, gpu: &Gpu, rows: u32) {
        let rows = rows.min(gpu.device.limits().max_texture_dimension_2d);
        let (texture, view) = make(gpu, self.label, self.format, [self.width, rows]);
        if self.pages_used > 0 {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            encoder.copy_texture_to_texture(
                self.texture.as_image_copy(),
                texture.as_image_copy(),
                self.texture.size(),
            );
            gpu.queue.submit([encoder.finish()]);
        }
        (self.texture, self.view) = (texture, view);
    }

    /// Writes bytes from a texel on, a rectangle for every part that is one.
    fn write(&self, gpu: &Gpu, first: u32, bytes: &[u8]) {
        let texel = self.texel_bytes() as usize;
        let width = self.width as usize;
        let (mut place, mut rest) = (first as usize, bytes);
        while !rest.is_empty() {
            let column = place % width;
            let texels = rest.len() / texel;
            let (columns, rows) = match column == 0 && texels >= width {
                true => (width, texels / width),
                false => (texels.min(width - column), 1),
            };
            let (part, after) = rest.split_at(columns * rows * texel);
            gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    texture: &self.texture,
                    mip_level: 0,
                    origin: wgpu::Origin3d {
                        x: column as u32,
                        y: (place / width) as u32,
                        z: 0,
                    },
                    aspect: wgpu::TextureAspect::All,
                },
                part,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some((columns * texel) as u32),
                    rows_per_image: Some(rows as u32),
                },
                wgpu::Extent3d {
                    width: columns as u32,
                    height: rows as u32,
                    depth_or_array_layers: 1,
                },
            );
            place += columns * rows;
            rest = after;
        }
    }
}

fn make(
    gpu: &Gpu,
    label: &str,
    format: wgpu::TextureFormat,
    size: [u32; 2],
) -> (wgpu::Texture, wgpu::TextureView) {
    let texture = tile_texture(gpu, label, size, [1, 1], format);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    (texture, view)
}
