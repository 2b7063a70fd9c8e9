//! How many tiles are read before they are handed to the device.

use crate::gpu::{Gpu, GpuError};

/// Tiles read in parallel at a time: bounds the memory beside the GPU's.
pub const BATCH: usize = 32;

/// Hands queued uploads to the device so that their staging memory is freed.
pub fn flush(gpu: &Gpu) -> Result<(), GpuError> {
    gpu.queue.submit([]);
    gpu.wait()
}
