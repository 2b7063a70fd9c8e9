//! Buffers and texture arrays filled from memory.

use wgpu::util::{BufferInitDescriptor, DeviceExt};

use super::{Gpu, GpuError};

/// A read-only storage buffer; never empty, because a binding may not be.
pub fn storage_buffer<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &'static str,
    records: &[T],
) -> Result<wgpu::Buffer, GpuError> {
    let bytes: &[u8] = bytemuck::cast_slice(records);
    let allowed = gpu.device.limits().max_storage_buffer_binding_size;
    gpu.require(label, bytes.len() as u64, allowed)?;
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    Ok(filled_buffer(gpu, label, bytes, usage))
}

/// A vertex or index buffer.
///
/// # Errors
/// When it is larger than the device allows.
pub fn geometry_buffer<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &'static str,
    records: &[T],
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer, GpuError> {
    let bytes: &[u8] = bytemuck::cast_slice(records);
    gpu.require(label, bytes.len() as u64, gpu.device.limits().max_buffer_size)?;
    Ok(filled_buffer(gpu, label, bytes, usage))
}

fn filled_buffer(gpu: &Gpu, label: &str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.count_creation();
    gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some(label),
        contents: if bytes.is_empty() { &[0; 64] } else { bytes },
        usage,
    })
}

/// A buffer that is filled later, by the queue or by a shader.
pub fn empty_buffer(gpu: &Gpu, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.count_creation();
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}

/// A uniform buffer that is written again before each use.
pub struct Uniform<T> {
    /// The buffer.
    pub buffer: wgpu::Buffer,
    of: std::marker::PhantomData<T>,
}

impl<T: bytemuck::NoUninit> Uniform<T> {
    /// An unwritten one.
    pub fn new(gpu: &Gpu, label: &str) -> Self {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        Self {
            buffer: empty_buffer(gpu, label, size_of::<T>() as u64, usage),
            of: std::marker::PhantomData,
        }
    }

    /// What the next submission will read.
    pub fn write(&self, gpu: &Gpu, value: &T) {
        gpu.queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(value));
    }

    /// For a bind group.
    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        self.buffer.as_entire_binding()
    }
}

/// A texture, or an array of them, that shaders read, and that is written and copied in parts.
pub(super) fn tile_texture(
    gpu: &Gpu,
    label: &str,
    [width, height]: [u32; 2],
    [levels, layers]: [u32; 2],
    format: wgpu::TextureFormat,
) -> wgpu::Texture {
    gpu.count_creation();
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: layers,
        },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// A 2D texture of four numbers a texel that is written whole, again and again.
pub struct TableTexture {
    texture: wgpu::Texture,
    /// What shaders read.
    pub view: wgpu::TextureView,
}

impl TableTexture {
    /// An unwritten one.
    pub fn new(gpu: &Gpu, label: &str, size: [u32; 2]) -> Self {
        let texture = tile_texture(gpu, label, size, [1, 1], wgpu::TextureFormat::Rgba32Uint);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view }
    }

    /// Writes all texels, row by row.
    pub fn write(&self, gpu: &Gpu, texels: &[[u32; 4]]) {
        gpu.queue.write_texture(
            self.texture.as_image_copy(),
            bytemuck::cast_slice(texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(self.texture.width() * size_of::<[u32; 4]>() as u32),
                rows_per_image: Some(self.texture.height()),
            },
            self.texture.size(),
        );
    }
}

/// A 2D texture of one level filled from memory, to be read by shaders.
pub fn filled_texture<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    texels: &[T],
) -> wgpu::TextureView {
    filled(
        gpu,
        label,
        [width, height, 1],
        (wgpu::TextureDimension::D2, format),
        texels,
    )
}

/// The same of a 3D texture, slice by slice.
pub fn filled_volume<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &str,
    size: [u32; 3],
    format: wgpu::TextureFormat,
    texels: &[T],
) -> wgpu::TextureView {
    filled(gpu, label, size, (wgpu::TextureDimension::D3, format), texels)
}

fn filled<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &str,
    [width, height, depth]: [u32; 3],
    (dimension, format): (wgpu::TextureDimension, wgpu::TextureFormat),
    texels: &[T],
) -> wgpu::TextureView {
    gpu.count_creation();
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: depth,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(texels),
    );
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
