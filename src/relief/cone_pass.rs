//! Distances that whole blocks of pixels can skip before the exact walk begins (`shaders/relief/cone.wgsl` tells how).

use super::context::{PassContext, pass_number};
use super::shaders::CONE;
use crate::gpu::{Gpu, PipelineParameters, color_target, shader_module};

/// The pipeline.
pub struct ConePass {
    pipeline: wgpu::RenderPipeline,
}

impl ConePass {
    /// For the layouts of groups 0 and 1.
    pub fn new(gpu: &Gpu, layouts: [&wgpu::BindGroupLayout; 2]) -> Self {
        let module = shader_module(gpu, &CONE);
        let targets = [color_target(wgpu::TextureFormat::R32Float)];
        Self {
            pipeline: gpu.pipeline(&PipelineParameters::fullscreen(
                "cone", &module, &layouts, &targets,
            )),
        }
    }

    /// Encodes the pass: the beginning of the buildings' time.
    pub fn encode(&self, context: &mut PassContext<'_>) {
        let mut pass = context.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("cone"),
            color_attachments: &[context.targets.cone_distance.cleared(wgpu::Color::TRANSPARENT)],
            timestamp_writes: context.timer.pass_begin(pass_number::BUILDINGS),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, context.frame, &[]);
        pass.set_bind_group(1, context.city, &[]);
        pass.draw(0..3, 0..1);
    }
}
