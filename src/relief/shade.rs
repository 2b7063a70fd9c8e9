//! Lights the surfaces that the ground and relief passes found.

use super::MapBindings;
use super::bindings::{FLOAT, group_of, layout_of, texture};
use super::shaders::SHADE;
use super::targets::ReliefTargets;
use crate::gpu::{Gpu, color_target, fullscreen_pipeline, shader_module};
use crate::scene::Resident;

/// The pipeline.
pub struct ShadePass {
    /// One ray to the sun.
    plain: wgpu::RenderPipeline,
    /// Samples of the sun's disc and the sky.
    stochastic: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
}

impl ShadePass {
    /// For a building map's bindings.
    pub fn new(gpu: &Gpu, frame_layout: &wgpu::BindGroupLayout, map: &MapBindings) -> Self {
        use wgpu::TextureSampleType::{Float, Uint};
        let module = shader_module(gpu, &SHADE);
        let layout = layout_of(
            gpu,
            "shade",
            &[
                texture(FLOAT, false),
                texture(Uint, false),
                texture(Uint, false),
                texture(Float { filterable: true }, true),
                wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            ],
        );
        let pipeline = |stochastic: bool| {
            fullscreen_pipeline(
                gpu,
                &module,
                &[Some(frame_layout), Some(&map.layout), Some(&layout)],
                &[
                    color_target(wgpu::TextureFormat::Rgba16Float),
                    color_target(wgpu::TextureFormat::R32Float),
                    color_target(wgpu::TextureFormat::R32Uint),
                ],
                &[("STOCHASTIC", f64::from(u8::from(stochastic)))],
            )
        };
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("photo"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        Self {
            plain: pipeline(false),
            stochastic: pipeline(true),
            layout,
            sampler,
        }
    }

    /// Encodes the pass.
    #[allow(clippy::too_many_arguments)]
    pub fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        resident: &Resident,
        frame: &wgpu::BindGroup,
        map: &MapBindings,
        sample: u32,
        targets: &ReliefTargets,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        use wgpu::BindingResource::{Sampler, TextureView};
        let group = group_of(
            gpu,
            "shade",
            &self.layout,
            vec![
                TextureView(&targets.ground_distance.view),
                TextureView(&targets.ground_normal.view),
                TextureView(&targets.relief.view),
                TextureView(&resident.imagery.view),
                Sampler(&self.sampler),
            ],
        );
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shade"),
            color_attachments: &[
                targets.radiance.cleared(wgpu::Color::BLACK),
                targets.distance.cleared(super::targets::FAR),
                targets.id.cleared(wgpu::Color::TRANSPARENT),
            ],
            timestamp_writes: timestamps,
            ..Default::default()
        });
        pass.set_pipeline(if sample > 0 { &self.stochastic } else { &self.plain });
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &map.group, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
