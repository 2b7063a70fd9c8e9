//! Distances that whole blocks of pixels can skip before the exact walk begins (`shaders/relief/cone.wgsl` tells how).

use super::MapBindings;
use super::shaders::CONE;
use super::targets::ReliefTargets;
use crate::gpu::{Gpu, color_target, fullscreen_pipeline, shader_module};

/// The pipeline.
pub struct ConePass {
    pipeline: wgpu::RenderPipeline,
}

impl ConePass {
    /// For a building map's bindings.
    pub fn new(gpu: &Gpu, frame_layout: &wgpu::BindGroupLayout, map: &MapBindings) -> Self {
        let module = shader_module(gpu, &CONE);
        let pipeline = fullscreen_pipeline(
            gpu,
            &module,
            &[Some(frame_layout), Some(&map.layout)],
            &[color_target(wgpu::TextureFormat::R32Float)],
            &[],
        );
        Self { pipeline }
    }

    /// Encodes the pass.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        map: &MapBindings,
        targets: &ReliefTargets,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("cone"),
            color_attachments: &[targets.cone_distance.cleared(wgpu::Color::TRANSPARENT)],
            timestamp_writes: timestamps,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &map.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
