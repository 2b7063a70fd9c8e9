//! Sums samples and develops the sum into 8-bit sRGB.

use super::shaders::{ACCUMULATE, TONEMAP};
use crate::gpu::{Gpu, Target, color_target, fullscreen_pipeline, shader_module, uniform_buffer};

/// Two sums that take turns, and the tone_mapped picture.
pub struct Develop {
    accumulate: wgpu::RenderPipeline,
    tonemap: wgpu::RenderPipeline,
    accumulate_layout: wgpu::BindGroupLayout,
    tonemap_layout: wgpu::BindGroupLayout,
    sums: [Target; 2],
    /// Radiance that the lens adds; black until something draws on it.
    pub flare: Target,
    /// The picture, RGBA sRGB.
    pub picture: Target,
}

const SUM: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

fn texture_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}

impl Develop {
    /// Format of `flare`.
    pub const FLARE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

    /// For pictures of `size` pixels.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let layout = |entries: &[wgpu::BindGroupLayoutEntry]| {
            gpu.device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries })
        };
        let accumulate_layout = layout(&[texture_entry(0), texture_entry(1)]);
        let exposure_entry = wgpu::BindGroupLayoutEntry {
            binding: 1,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let tonemap_layout = layout(&[texture_entry(0), exposure_entry, texture_entry(2)]);
        let pipeline = |source, layout, format| {
            let module = shader_module(gpu, source);
            fullscreen_pipeline(gpu, &module, &[Some(layout)], &[color_target(format)], &[])
        };
        Self {
            accumulate: pipeline(&ACCUMULATE, &accumulate_layout, SUM),
            tonemap: pipeline(&TONEMAP, &tonemap_layout, PICTURE),
            accumulate_layout,
            tonemap_layout,
            sums: [
                Target::new(gpu, "sum 0", size, SUM),
                Target::new(gpu, "sum 1", size, SUM),
            ],
            flare: Target::new(gpu, "flare", size, Self::FLARE),
            picture: Target::new(gpu, "picture", size, PICTURE),
        }
    }

    /// Adds sample number `index` (from 0) to the sum.
    pub fn encode_sample(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        radiance: &Target,
        index: u32,
    ) {
        let [before, after] = if index.is_multiple_of(2) {
            [&self.sums[1], &self.sums[0]]
        } else {
            [&self.sums[0], &self.sums[1]]
        };
        if index == 0 {
            drop(pass(encoder, before));
        }
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("accumulate"),
            layout: &self.accumulate_layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&before.view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(&radiance.view),
                },
            ],
        });
        let mut pass = pass(encoder, after);
        pass.set_pipeline(&self.accumulate);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Exposes and tone-maps the mean of `samples` samples.
    pub fn encode_picture(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, samples: u32, exposure: f32) {
        let sum = &self.sums[(samples as usize + 1) % 2];
        let scale = uniform_buffer(gpu, "exposure", &[exposure / samples as f32, exposure, 0.0, 0.0]);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("tonemap"),
            layout: &self.tonemap_layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&sum.view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: scale.as_entire_binding(),
                },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::TextureView(&self.flare.view),
                },
            ],
        });
        let mut pass = pass(encoder, &self.picture);
        pass.set_pipeline(&self.tonemap);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn pass<'a>(encoder: &'a mut wgpu::CommandEncoder, target: &Target) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("develop"),
        color_attachments: &[target.cleared(wgpu::Color::TRANSPARENT)],
        ..Default::default()
    })
}
