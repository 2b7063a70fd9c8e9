//! Casts the rays of light from all round, at half the image's size (`shaders/relief/ambient.wgsl` tells how).

use wgpu::TextureSampleType::Uint;

use super::context::{PassContext, pass_number};
use super::shaders::AMBIENT;
use super::targets::ReliefTargets;
use crate::gpu::{BySize, FLOAT, Gpu, PipelineParameters, color_target, shader_module, texture};

/// The pipeline.
pub struct AmbientPass {
    pipeline: wgpu::RenderPipeline,
    input_layout: wgpu::BindGroupLayout,
    input: BySize<wgpu::BindGroup>,
}

impl AmbientPass {
    /// Group 2: the ground's distance and normal, the buildings' surface.
    pub const INPUT: [wgpu::BindingType; 3] = [texture(FLOAT), texture(Uint), texture(Uint)];

    /// For the layouts of groups 0 and 1.
    pub fn new(gpu: &Gpu, [frame, city]: [&wgpu::BindGroupLayout; 2]) -> Self {
        let module = shader_module(gpu, &AMBIENT);
        let input_layout = gpu.layout("ambient input", &Self::INPUT);
        let layouts = [frame, city, &input_layout];
        let targets = [color_target(wgpu::TextureFormat::Rg32Uint)];
        Self {
            pipeline: gpu.pipeline(&PipelineParameters::fullscreen(
                "ambient", &module, &layouts, &targets,
            )),
            input_layout,
            input: BySize::default(),
        }
    }

    /// Binds the targets of a new size.
    pub fn bind(&mut self, gpu: &Gpu, targets: &ReliefTargets) {
        let resources = [
            targets.ground_distance.binding(),
            targets.ground_normal.binding(),
            targets.building_surface.binding(),
        ];
        let layout = &self.input_layout;
        self.input
            .select(targets.size, || gpu.group("ambient input", layout, &resources));
    }

    /// Encodes the pass: the beginning of the light's time.
    pub fn encode(&self, context: &mut PassContext<'_>) {
        let (targets, band) = (context.targets, context.band);
        let mut pass = context.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("ambient"),
            color_attachments: &[band.attachment(&targets.ambient_rays, wgpu::Color::TRANSPARENT)],
            timestamp_writes: context.timer.pass_begin(pass_number::LIGHT),
            ..Default::default()
        });
        if !band.confine_half(&mut pass, targets.size) {
            return;
        }
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, context.frame, &[]);
        pass.set_bind_group(1, context.city, &[]);
        pass.set_bind_group(2, self.input.current(), &[]);
        pass.draw(0..3, 0..1);
    }
}
