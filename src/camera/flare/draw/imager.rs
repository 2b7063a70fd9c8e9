//! A flare alone: drawn on black and read back.

use super::{FlareEffect, FlareRequest, MeshStatistics};
use crate::camera::lens::Lens;
use crate::gpu::{Gpu, GpuError, PassTimer, Target, read_texture};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A flare in memory.
pub struct FlareImage {
    /// Linear radiance, RGB, rows from the top.
    pub radiance: Vec<[f32; 3]>,
    /// Of its ghosts.
    pub mesh: MeshStatistics,
    /// GPU milliseconds, where the device can time.
    pub gpu_ms: Option<f64>,
}

/// What draws flares alone.
pub struct FlareImager<'a> {
    gpu: &'a Gpu,
    effect: FlareEffect,
    timer: PassTimer,
    target: Option<([u32; 2], Target)>,
}

impl<'a> FlareImager<'a> {
    /// Compiles the shaders.
    pub fn new(gpu: &'a Gpu) -> Self {
        Self {
            gpu,
            effect: FlareEffect::new(gpu, FORMAT),
            timer: PassTimer::new(gpu, &["flare"]),
            target: None,
        }
    }

    /// Draws a flare on `size` pixels; sums that a half float does not hold are the largest that it does.
    ///
    /// # Errors
    /// When the device fails.
    pub fn draw(&mut self, request: &FlareRequest, size: [u32; 2]) -> Result<FlareImage, GpuError> {
        let gpu = self.gpu;
        self.effect.prepare(gpu, request, size)?;
        let (_, target) = match self.target.take() {
            Some(known) if known.0 == size => self.target.insert(known),
            _ => self
                .target
                .insert((size, Target::new(gpu, "flare", size, FORMAT))),
        };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear"),
            color_attachments: &[target.cleared(wgpu::Color::TRANSPARENT)],
            ..Default::default()
        }));
        self.effect.encode(&mut encoder, target, Some((&self.timer, 0)));
        self.timer.resolve(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()?;
        let halves = read_texture::<[half::f16; 4]>(gpu, &target.texture)?;
        Ok(FlareImage {
            radiance: halves
                .iter()
                .map(|texel| [texel[0], texel[1], texel[2]].map(|value| value.min(half::f16::MAX).to_f32()))
                .collect(),
            mesh: self.effect.statistics(),
            gpu_ms: self.timer.read(gpu)?.map(|times| times[0].1),
        })
    }
}

/// Half the film that an image of `size` pixels shows when its width is the film's, millimetres.
pub fn film_half_mm(lens: &Lens, size: [u32; 2]) -> [f64; 2] {
    let half_width = 0.5 * lens.film_mm[0];
    [half_width, half_width * f64::from(size[1]) / f64::from(size[0])]
}
