//! Draws the ground: distance along the view ray and normal.

use super::context::{PassContext, pass_number};
use super::shaders::GROUND;
use super::targets::{FAR_COLOR, reversed_depth};
use crate::gpu::{Gpu, PipelineParameters, color_target, shader_module};
use crate::scene::nearest_first;

/// The pipeline.
pub struct GroundPass {
    pipeline: wgpu::RenderPipeline,
}

impl GroundPass {
    /// For the layouts of groups 0 and 1.
    pub fn new(gpu: &Gpu, layouts: [&wgpu::BindGroupLayout; 2]) -> Self {
        let module = shader_module(gpu, &GROUND);
        Self {
            pipeline: gpu.pipeline(&PipelineParameters {
                label: "ground",
                module: &module,
                layouts: &layouts,
                vertex: "vs",
                buffers: &[],
                primitive: wgpu::PrimitiveState {
                    cull_mode: Some(wgpu::Face::Back),
                    ..Default::default()
                },
                depth: Some(reversed_depth()),
                targets: &[
                    color_target(wgpu::TextureFormat::R32Float),
                    color_target(wgpu::TextureFormat::R32Uint),
                ],
            }),
        }
    }

    /// Encodes the pass: visible tiles, the nearest first.
    pub fn encode(&self, context: &mut PassContext<'_>) {
        let targets = context.targets;
        let mut pass = context.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("ground"),
            color_attachments: &[
                targets.ground_distance.cleared(FAR_COLOR),
                targets.ground_normal.cleared(wgpu::Color::TRANSPARENT),
            ],
            depth_stencil_attachment: targets.depth.cleared_depth(),
            timestamp_writes: context.timer.pass(pass_number::GROUND),
            ..Default::default()
        });
        let (grid, ground) = (&context.resident.tiles.grid, &context.resident.ground);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, context.frame, &[]);
        pass.set_bind_group(1, context.city, &[]);
        pass.set_index_buffer(ground.indices.slice(..), wgpu::IndexFormat::Uint32);
        let tiles: Vec<_> = ground.slots.iter().map(|slot| slot.tile).collect();
        for index in nearest_first(grid, &tiles, context.projection.pose.eye.truncate()) {
            let slot = &ground.slots[index];
            let [min, max] = slot.range.map(f64::from);
            if context.frustum.sees(&grid.tile_bounds(slot.tile), min, max) {
                pass.draw_indexed(slot.indices.clone(), 0, index as u32..index as u32 + 1);
            }
        }
    }
}
