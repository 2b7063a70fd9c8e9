//! Where grids of rays are traced: on the CPU in f64, or on the GPU in f32.

use rayon::prelude::*;

use super::grid::RayGrid;
use crate::camera::lens::Lens;
use crate::camera::ray_bundles::{Bundle, RayPass};
use crate::camera::trace::{Tracer, beam_direction};
use crate::gpu::{Gpu, GpuError};

/// Which of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TracingDevice {
    /// f64, all cores.
    Cpu,
    /// f32.
    #[default]
    Gpu,
}

/// It, with what it needs.
#[derive(Clone, Copy)]
pub enum Tracing<'a> {
    /// f64, all cores.
    Cpu,
    /// f32.
    Gpu(&'a Gpu, &'a RayPass),
}

impl Tracing<'_> {
    /// A grid of `size` x `size` rays for every bundle.
    pub fn grids(
        &self,
        lens: &Lens,
        sensor_gap_mm: f64,
        bundles: &[Bundle],
        size: usize,
    ) -> Result<Vec<RayGrid>, GpuError> {
        let size = size.max(2);
        Ok(match self {
            Self::Cpu => bundles
                .par_iter()
                .map(|bundle| {
                    let tracer = Tracer::new(lens, bundle.wavelength_um, sensor_gap_mm);
                    let mut grid = RayGrid::new(bundle, size, Vec::with_capacity(size * size));
                    for k in 0..size * size {
                        let direction = beam_direction(bundle.angle);
                        let ray = tracer.trace(bundle.ghost, grid.entry(k), direction);
                        grid.rays.push(ray);
                    }
                    grid
                })
                .collect(),
            Self::Gpu(gpu, pass) => pass
                .trace(gpu, lens, sensor_gap_mm, bundles, size)?
                .into_iter()
                .zip(bundles)
                .map(|(rays, bundle)| RayGrid::new(bundle, size, rays))
                .collect(),
        })
    }
}
