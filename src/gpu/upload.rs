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

/// A 2D texture of one level filled from memory, to be read by shaders.
pub fn filled_texture<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
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
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(texels),
    );
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// A 2D array texture, one layer a tile.
pub struct TextureArray {
    texture: wgpu::Texture,
    /// View of all layers and levels.
    pub view: wgpu::TextureView,
}

impl TextureArray {
    /// `layers` layers of `size` texels with `levels` mip levels.
    pub fn new(
        gpu: &Gpu,
        label: &'static str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        [levels, layers]: [u32; 2],
    ) -> Result<Self, GpuError> {
        let [width, height] = size;
        let limits = gpu.device.limits();
        gpu.require(
            label,
            u64::from(width.max(height)),
            u64::from(limits.max_texture_dimension_2d),
        )?;
        gpu.require(
            label,
            u64::from(layers),
            u64::from(limits.max_texture_array_layers),
        )?;
        gpu.count_creation();
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: layers.max(1),
            },
            mip_level_count: levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        Ok(Self { texture, view })
    }

    /// Writes one mip level of one layer.
    pub fn write<T: bytemuck::NoUninit>(&self, gpu: &Gpu, layer: u32, level: u32, texels: &[T]) {
        let width = (self.texture.width() >> level).max(1);
        let height = (self.texture.height() >> level).max(1);
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
