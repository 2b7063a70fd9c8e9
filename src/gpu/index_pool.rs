//! Room for the indices of many meshes in one buffer that grows.

use std::ops::Range;

use offset_allocator::{Allocation, Allocator};

use super::{Gpu, GpuError, empty_buffer};

/// Indices that are handed out together.
const PAGE: u32 = 256;
const INDEX_BYTES: u64 = size_of::<u32>() as u64;

/// The indices of one mesh.
#[derive(Clone, Copy)]
pub struct IndexRun {
    /// Its first index.
    pub first: u32,
    pages: u32,
    allocation: Allocation,
}

/// An index buffer of many meshes.
pub struct IndexPool {
    label: &'static str,
    /// The buffer.
    pub buffer: wgpu::Buffer,
    allocator: Allocator,
    pages_used: u32,
}

impl IndexPool {
    /// An empty pool.
    pub fn new(gpu: &Gpu, label: &'static str) -> Self {
        let pages = (gpu.device.limits().max_buffer_size / INDEX_BYTES / u64::from(PAGE)).min(1 << 24);
        Self {
            label,
            buffer: make(gpu, label, u64::from(PAGE)),
            allocator: Allocator::new(pages as u32),
            pages_used: 0,
        }
    }

    /// Bytes of the buffer.
    pub fn bytes(&self) -> u64 {
        self.buffer.size()
    }

    /// Writes a mesh.
    ///
    /// # Errors
    /// When the largest buffer of the device is full.
    pub fn put(&mut self, gpu: &Gpu, indices: &[u32]) -> Result<IndexRun, GpuError> {
        let pages = (indices.len() as u32).div_ceil(PAGE).max(1);
        let Some(allocation) = self.allocator.allocate(pages) else {
            let allowed = gpu.device.limits().max_buffer_size;
            gpu.require(self.label, allowed + 1, allowed)?;
            return Err(gpu.failed(self.label));
        };
        let run = IndexRun {
            first: allocation.offset * PAGE,
            pages,
            allocation,
        };
        self.pages_used += pages;
        self.reserve_to(gpu, u64::from(run.first) + u64::from(pages * PAGE));
        gpu.queue.write_buffer(
            &self.buffer,
            u64::from(run.first) * INDEX_BYTES,
            bytemuck::cast_slice(indices),
        );
        Ok(run)
    }

    /// Makes room for more indices at once.
    pub fn reserve(&mut self, gpu: &Gpu, indices: u64) {
        self.reserve_to(gpu, u64::from(self.pages_used) * u64::from(PAGE) + indices);
    }

    /// Gives a mesh's room back.
    pub fn free(&mut self, run: IndexRun) {
        self.pages_used -= run.pages;
        self.allocator.free(run.allocation);
    }

    fn reserve_to(&mut self, gpu: &Gpu, indices: u64) {
        if indices * INDEX_BYTES <= self.buffer.size() {
            return;
        }
        let allowed = gpu.device.limits().max_buffer_size / INDEX_BYTES;
        let buffer = make(gpu, self.label, (indices + indices / 2).min(allowed));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.buffer, 0, &buffer, 0, self.buffer.size());
        gpu.queue.submit([encoder.finish()]);
        self.buffer = buffer;
    }
}

fn make(gpu: &Gpu, label: &str, indices: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    empty_buffer(gpu, label, indices * INDEX_BYTES, usage)
}

impl IndexRun {
    /// A part of it.
    pub fn part(&self, part: &Range<u32>) -> Range<u32> {
        self.first + part.start..self.first + part.end
    }
}
