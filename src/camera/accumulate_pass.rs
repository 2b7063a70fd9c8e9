//! The sum of an image's samples.

use super::shaders::ACCUMULATE;
use crate::gpu::{BySize, FLOAT, Gpu, PipelineParameters, Target, color_target, shader_module, texture};

/// Two sums that take turns.
pub struct AccumulatePass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    sums: BySize<Sums>,
}

struct Sums {
    targets: [Target; 2],
    /// What each sum is made of: the other one and a sample.
    inputs: [wgpu::BindGroup; 2],
}

impl AccumulatePass {
    /// Group 0: the sum before, a sample's radiance.
    pub const INPUT: [wgpu::BindingType; 2] = [texture(FLOAT), texture(FLOAT)];
    /// Format of the sums.
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

    /// Compiles the pipeline.
    pub fn new(gpu: &Gpu) -> Self {
        let module = shader_module(gpu, &ACCUMULATE);
        let layout = gpu.layout("accumulate", &Self::INPUT);
        let targets = [color_target(Self::FORMAT)];
        Self {
            pipeline: gpu.pipeline(&PipelineParameters::fullscreen(
                "accumulate",
                &module,
                &[&layout],
                &targets,
            )),
            layout,
            sums: BySize::default(),
        }
    }

    /// Sums of `size` pixels of what `radiance` will hold.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2], radiance: &Target) {
        let layout = &self.layout;
        self.sums.select(size, || {
            let targets = ["sum 0", "sum 1"].map(|label| Target::new(gpu, label, size, Self::FORMAT));
            let input = |before: &Target| {
                let resources = [before.binding(), radiance.binding()];
                gpu.group("accumulate", layout, &resources)
            };
            Sums {
                inputs: [input(&targets[1]), input(&targets[0])],
                targets,
            }
        });
    }

    /// The sums, the one of an even number of the last sample first; none before the first size.
    pub fn targets(&self) -> Option<&[Target; 2]> {
        self.sums.current().map(|sums| &sums.targets)
    }

    /// Adds sample number `sample` (from 0, which begins the sum).
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sample: u32,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let Some(sums) = self.sums.current() else { return };
        let index = sample as usize % 2;
        if sample == 0 {
            drop(begin(encoder, &sums.targets[1], None));
        }
        let mut pass = begin(encoder, &sums.targets[index], timestamps);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &sums.inputs[index], &[]);
        pass.draw(0..3, 0..1);
    }
}

fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    target: &Target,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("accumulate"),
        color_attachments: &[target.cleared(wgpu::Color::TRANSPARENT)],
        timestamp_writes: timestamps,
        ..Default::default()
    })
}
