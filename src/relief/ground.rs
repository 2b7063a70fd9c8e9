//! Draws the ground: distance along the view ray and normal.

use super::bindings::{FLOAT, RECORDS, group_of, layout_of, texture};
use super::shaders::GROUND;
use super::targets::ReliefTargets;
use crate::gpu::{Gpu, color_target, shader_module};
use crate::scene::{Frustum, Resident, nearest_first};
use crate::space::View;

/// The pipeline and its bindings.
pub struct GroundPass {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
}

impl GroundPass {
    /// For a resident city.
    pub fn new(gpu: &Gpu, resident: &Resident, frame_layout: &wgpu::BindGroupLayout) -> Self {
        let module = shader_module(gpu, &GROUND);
        let layout = layout_of(gpu, "ground", &[RECORDS, texture(FLOAT, true)]);
        let group = group_of(
            gpu,
            "ground",
            &layout,
            vec![
                resident.ground_buffer.as_entire_binding(),
                wgpu::BindingResource::TextureView(&resident.heights.view),
            ],
        );
        let pipeline_layout = gpu
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("ground"),
                bind_group_layouts: &[Some(frame_layout), Some(&layout)],
                immediate_size: 0,
            });
        let pipeline = gpu
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("ground"),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vs"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState {
                    cull_mode: Some(wgpu::Face::Back),
                    ..Default::default()
                },
                depth_stencil: Some(super::targets::reversed_depth()),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fs"),
                    compilation_options: Default::default(),
                    targets: &[
                        color_target(wgpu::TextureFormat::R32Float),
                        color_target(wgpu::TextureFormat::R32Uint),
                    ],
                }),
                multiview_mask: None,
                cache: None,
            });
        Self { pipeline, group }
    }

    /// Encodes the pass: visible tiles, the nearest first.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        resident: &Resident,
        view: &View,
        frustum: &Frustum,
        frame: &wgpu::BindGroup,
        targets: &ReliefTargets,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("ground"),
            color_attachments: &[
                targets.ground_distance.cleared(super::targets::FAR),
                targets.ground_normal.cleared(wgpu::Color::TRANSPARENT),
            ],
            depth_stencil_attachment: targets.depth.cleared_depth(),
            timestamp_writes: timestamps,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(resident.ground_indices.slice(..), wgpu::IndexFormat::Uint32);
        let tiles: Vec<_> = resident.ground.iter().map(|slot| slot.tile).collect();
        for index in nearest_first(&resident.grid, &tiles, view.eye.truncate()) {
            let slot = &resident.ground[index];
            let [low, high] = slot.range.map(f64::from);
            if frustum.sees(&resident.grid.tile_bounds(slot.tile), low, high) {
                pass.draw_indexed(slot.indices.clone(), 0, index as u32..index as u32 + 1);
            }
        }
    }
}
