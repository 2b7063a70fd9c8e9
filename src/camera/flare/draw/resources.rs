//! What ghosts and sprites have in common: one layout (uniform, image, sampler), and pipelines that blend onto radiance.

use super::soft_masks::IrisMasks;
use crate::gpu::{FILTERED, Gpu, PipelineParameters, SAMPLER, UNIFORM, texture, texture_volume};

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
/// Group 0 of ghosts: uniform, the iris' mask, sampler, its softened masks.
pub const GHOST_INPUT: [wgpu::BindingType; 4] =
    [UNIFORM, texture(FILTERED), SAMPLER, texture_volume(FILTERED)];
/// Group 0 where an image alone is drawn on: image, sampler.
pub const IMAGE_INPUT: [wgpu::BindingType; 2] = [texture(FILTERED), SAMPLER];

/// The layouts, the sampler, and the format of the target.
pub struct Resources {
    layout: wgpu::BindGroupLayout,
    image_layout: wgpu::BindGroupLayout,
    ghost_layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    format: wgpu::TextureFormat,
}

impl Resources {
    /// For a target's format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        Self {
            layout: gpu.layout("flare", &FLARE_INPUT),
            image_layout: gpu.layout("flare", &IMAGE_INPUT),
            ghost_layout: gpu.layout("ghosts", &GHOST_INPUT),
            sampler: gpu.linear_sampler("flare", false),
            format,
        }
    }

    /// A pipeline of sprites, with the entries `vs` and `fs`.
    pub fn sprite_pipeline(&self, gpu: &Gpu, module: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
        let topology = wgpu::PrimitiveTopology::TriangleStrip;
        self.pipeline_of(gpu, &self.layout, module, (&[], topology), Blending::Added)
    }

    /// The same of ghosts.
    pub fn ghost_pipeline(
        &self,
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
        buffers: &[wgpu::VertexBufferLayout<'_>],
        blending: Blending,
    ) -> wgpu::RenderPipeline {
        let topology = wgpu::PrimitiveTopology::TriangleList;
        self.pipeline_of(gpu, &self.ghost_layout, module, (buffers, topology), blending)
    }

    /// The same over the whole target, with an image alone for its input.
    pub fn image_pipeline(&self, gpu: &Gpu, module: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
        let topology = wgpu::PrimitiveTopology::TriangleList;
        self.pipeline_of(gpu, &self.image_layout, module, (&[], topology), Blending::Added)
    }

    fn pipeline_of(
        &self,
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        module: &wgpu::ShaderModule,
        (buffers, topology): (&[wgpu::VertexBufferLayout<'_>], wgpu::PrimitiveTopology),
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
            layouts: &[layout],
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

    /// Group 0 of ghosts.
    pub fn ghost_group(
        &self,
        gpu: &Gpu,
        uniform: wgpu::BindingResource<'_>,
        masks: &IrisMasks,
    ) -> wgpu::BindGroup {
        let resources = [
            uniform,
            wgpu::BindingResource::TextureView(&masks.sharp),
            wgpu::BindingResource::Sampler(&self.sampler),
            wgpu::BindingResource::TextureView(&masks.soft),
        ];
        gpu.group("ghosts", &self.ghost_layout, &resources)
    }

    /// Group 0 of an image alone.
    pub fn image_group(&self, gpu: &Gpu, image: &wgpu::TextureView) -> wgpu::BindGroup {
        let resources = [
            wgpu::BindingResource::TextureView(image),
            wgpu::BindingResource::Sampler(&self.sampler),
        ];
        gpu.group("flare", &self.image_layout, &resources)
    }
}
