//! What ghosts and sprites have in common: one layout (uniform, image, sampler), and pipelines that blend onto radiance.

use crate::gpu::{FILTERED, Gpu, PipelineParameters, SAMPLER, UNIFORM, texture};

/// How the fragments of a pipeline meet what lies below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blending {
    /// They add up.
    Added,
    /// They mask what lies below by their alpha, and add.
    Masks,
}

/// Group 0: uniform, image, sampler.
pub const FLARE_INPUT: [wgpu::BindingType; 3] = [UNIFORM, texture(FILTERED), SAMPLER];

/// The layout, the sampler, and the format of the target.
pub struct Resources {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    format: wgpu::TextureFormat,
}

impl Resources {
    /// For a target's format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        Self {
            layout: gpu.layout("flare", &FLARE_INPUT),
            sampler: gpu.linear_sampler("flare", false),
            format,
        }
    }

    /// A pipeline with the entries `vs` and `fs`.
    pub fn pipeline(
        &self,
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
        buffers: &[wgpu::VertexBufferLayout<'_>],
        topology: wgpu::PrimitiveTopology,
        blending: Blending,
    ) -> wgpu::RenderPipeline {
        let blend = |src_factor, dst_factor| wgpu::BlendComponent {
            src_factor,
            dst_factor,
            operation: wgpu::BlendOperation::Add,
        };
        let below = match blending {
            Blending::Added => wgpu::BlendFactor::One,
            Blending::Masks => wgpu::BlendFactor::OneMinusSrcAlpha,
        };
        gpu.pipeline(&PipelineParameters {
            label: "flare",
            module,
            layouts: &[&self.layout],
            vertex: "vs",
            buffers,
            primitive: wgpu::PrimitiveState {
                topology,
                ..Default::default()
            },
            depth: None,
            targets: &[Some(wgpu::ColorTargetState {
                format: self.format,
                blend: Some(wgpu::BlendState {
                    color: blend(wgpu::BlendFactor::One, below),
                    alpha: blend(wgpu::BlendFactor::Zero, wgpu::BlendFactor::One),
                }),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        })
    }

    /// Group 0.
    pub fn group(
        &self,
        gpu: &Gpu,
        uniform: wgpu::BindingResource<'_>,
        image: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let resources = [
            uniform,
            wgpu::BindingResource::TextureView(image),
            wgpu::BindingResource::Sampler(&self.sampler),
        ];
        gpu.group("flare", &self.layout, &resources)
    }
}
