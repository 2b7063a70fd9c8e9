//! Small records in one storage buffer that grows: a slot a record.

use super::{Gpu, GpuError, empty_buffer};

/// Records and their free slots.
pub struct RecordPool<T> {
    label: &'static str,
    /// What shaders read.
    pub buffer: wgpu::Buffer,
    records: Vec<T>,
    free: Vec<u32>,
}

impl<T: bytemuck::NoUninit> RecordPool<T> {
    /// An empty pool.
    pub fn new(gpu: &Gpu, label: &'static str) -> Self {
        Self {
            label,
            buffer: make::<T>(gpu, label, 1),
            records: Vec::new(),
            free: Vec::new(),
        }
    }

    /// Writes a record; its slot, and true when the buffer was made anew for it.
    ///
    /// # Errors
    /// When the device allows no larger buffer.
    pub fn put(&mut self, gpu: &Gpu, record: T) -> Result<(u32, bool), GpuError> {
        let slot = match self.free.pop() {
            Some(slot) => slot,
            None => self.records.len() as u32,
        };
        match self.records.get_mut(slot as usize) {
            Some(place) => *place = record,
            None => self.records.push(record),
        }
        let size = size_of::<T>() as u64;
        let grows = self.buffer.size() < size * self.records.len() as u64;
        if grows {
            let allowed = gpu.device.limits().max_storage_buffer_binding_size;
            gpu.require(self.label, size * self.records.len() as u64, allowed)?;
            let count = (2 * self.records.len() as u64).min(allowed / size);
            self.buffer = make::<T>(gpu, self.label, count);
            gpu.queue
                .write_buffer(&self.buffer, 0, bytemuck::cast_slice(&self.records));
        } else {
            gpu.queue
                .write_buffer(&self.buffer, size * u64::from(slot), bytemuck::bytes_of(&record));
        }
        Ok((slot, grows))
    }

    /// Gives a slot back.
    pub fn free(&mut self, slot: u32) {
        self.free.push(slot);
    }
}

fn make<T>(gpu: &Gpu, label: &str, count: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    empty_buffer(gpu, label, size_of::<T>() as u64 * count, usage)
}
