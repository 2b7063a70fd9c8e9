//! GPU time per pass, by timestamp queries.

use super::{Gpu, GpuError};

/// Times the named passes of one submission.
pub struct PassTimer {
    queries: Option<(wgpu::QuerySet, wgpu::Buffer, wgpu::Buffer)>,
    names: &'static [&'static str],
    period_ns: f32,
}

/// Milliseconds of each pass, by name.
pub type PassTimes = Vec<(&'static str, f64)>;

impl PassTimer {
    /// A timer; on a device without timestamps it measures nothing.
    pub fn new(gpu: &Gpu, names: &'static [&'static str]) -> Self {
        let capacity = names.len() as u32;
        let queries = gpu.has_timestamps.then(|| {
            gpu.count_creation();
            let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * capacity,
            });
            let buffer = |usage| {
                gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("pass times"),
                    size: u64::from(16 * capacity),
                    usage,
                    mapped_at_creation: false,
                })
            };
            let resolve = buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
            let read = buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
            (set, resolve, read)
        });
        Self {
            queries,
            names,
            period_ns: gpu.queue.get_timestamp_period(),
        }
    }

    /// The timestamps of pass number `pass` of the names.
    pub fn pass(&self, pass: u32) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (set, _, _) = self.queries.as_ref()?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: set,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        })
    }

    /// The timestamp at the beginning of a timed pass that is made of several render passes, for the first of them.
    pub fn pass_begin(&self, pass: u32) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.pass(pass).map(|both| wgpu::RenderPassTimestampWrites {
            end_of_pass_write_index: None,
            ..both
        })
    }

    /// The timestamp at its end, for the last of them.
    pub fn pass_end(&self, pass: u32) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.pass(pass).map(|both| wgpu::RenderPassTimestampWrites {
            beginning_of_pass_write_index: None,
            ..both
        })
    }

    /// Call after the last pass, before submitting.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some((set, resolve, read)) = &self.queries {
            let count = 2 * self.names.len() as u32;
            encoder.resolve_query_set(set, 0..count, resolve, 0);
            encoder.copy_buffer_to_buffer(resolve, 0, read, 0, u64::from(8 * count));
        }
    }

    /// Milliseconds of every pass in the order of the names; none without timestamps. Every pass must have been
    /// encoded. Waits for the device.
    pub fn read(&self, gpu: &Gpu) -> Result<Option<PassTimes>, GpuError> {
        let Some((_, _, read)) = &self.queries else {
            return Ok(None);
        };
        read.map_async(wgpu::MapMode::Read, .., |_| {});
        gpu.wait()?;
        let times = {
            let bytes = read.get_mapped_range(..).map_err(|error| gpu.failed(error))?;
            bytemuck::pod_collect_to_vec::<u8, u64>(&bytes)
        };
        read.unmap();
        let (pairs, _) = times.as_chunks::<2>();
        let spans = self.names.iter().zip(pairs).map(|(&name, [begin, end])| {
            let ms = end.saturating_sub(*begin) as f64 * f64::from(self.period_ns) * 1e-6;
            (name, ms)
        });
        Ok(Some(spans.collect()))
    }
}
