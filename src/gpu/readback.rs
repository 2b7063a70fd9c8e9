//! Copies textures and buffers back to memory.

use super::{Gpu, GpuError};

/// All texels of a 2D texture, rows from the top without padding. `T` is a texel's component or a whole texel.
pub fn read_texture<T: bytemuck::Pod>(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<T>, GpuError> {
    let size = texture.size();
    let texel_bytes = texture.format().block_copy_size(None).unwrap_or(4);
    let row_bytes = size.width * texel_bytes;
    let padded = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    gpu.count_creation();
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size: u64::from(padded) * u64::from(size.height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: None,
            },
        },
        size,
    );
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.wait()?;
    let bytes = buffer.get_mapped_range(..).map_err(|error| gpu.failed(error))?;
    Ok(bytes
        .chunks_exact(padded as usize)
        .flat_map(|row| bytemuck::pod_collect_to_vec::<u8, T>(&row[..row_bytes as usize]))
        .collect())
}

/// All records of a buffer that can be copied from. Waits for the device.
pub fn read_buffer<T: bytemuck::Pod>(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<T>, GpuError> {
    gpu.count_creation();
    let read = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size: buffer.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &read, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    read.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.wait()?;
    let bytes = read.get_mapped_range(..).map_err(|error| gpu.failed(error))?;
    Ok(bytemuck::pod_collect_to_vec(&bytes))
}
