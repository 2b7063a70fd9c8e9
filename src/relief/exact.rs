//! Draws the buildings out of the building map: overflow faces on the border of the tiles' volume, an exact
//! walk per pixel, tile after tile, the nearest first (`shaders/relief/exact.wgsl` tells how).

use super::MapBindings;
use super::bindings::{FLOAT, group_of, layout_of, texture};
use super::shaders::EXACT;
use super::targets::ReliefTargets;
use crate::gpu::{Gpu, shader_module};

/// The pipeline.
pub struct ExactPass {
    /// Faces of the tiles' volume.
    overflow: wgpu::RenderPipeline,
    /// The face behind all others.
    last: wgpu::RenderPipeline,
    input_layout: wgpu::BindGroupLayout,
}

/// Vertices of the tiles' volume: six faces of two triangles.
const VOLUME_VERTICES: u32 = 36;

impl ExactPass {
    /// For a building map's bindings.
    pub fn new(gpu: &Gpu, frame_layout: &wgpu::BindGroupLayout, map: &MapBindings) -> Self {
        let module = shader_module(gpu, &EXACT);
        let input_layout = layout_of(
            gpu,
            "relief input",
            &[texture(FLOAT, false), texture(FLOAT, false)],
        );
        let layout = gpu
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("exact"),
                bind_group_layouts: &[Some(frame_layout), Some(&map.layout), Some(&input_layout)],
                immediate_size: 0,
            });
        let pipeline = |entry_point, cull_mode| {
            gpu.device
                .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some("exact"),
                    layout: Some(&layout),
                    vertex: wgpu::VertexState {
                        module: &module,
                        entry_point: Some(entry_point),
                        compilation_options: Default::default(),
                        buffers: &[],
                    },
                    primitive: wgpu::PrimitiveState {
                        cull_mode,
                        ..Default::default()
                    },
                    depth_stencil: Some(super::targets::reversed_depth()),
                    multisample: wgpu::MultisampleState::default(),
                    fragment: Some(wgpu::FragmentState {
                        module: &module,
                        entry_point: Some("fs"),
                        compilation_options: Default::default(),
                        targets: &super::targets::relief_target_states(),
                    }),
                    multiview_mask: None,
                    cache: None,
                })
        };
        // Faces that look away from the viewer: they cover the volume also from inside it.
        let overflow = pipeline("vs_overflow", Some(wgpu::Face::Front));
        let last = pipeline("vs_last", None);
        Self {
            overflow,
            last,
            input_layout,
        }
    }

    /// Encodes the pass.
    #[allow(clippy::too_many_arguments)]
    pub fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        map: &MapBindings,
        targets: &ReliefTargets,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let input = group_of(
            gpu,
            "relief input",
            &self.input_layout,
            vec![
                wgpu::BindingResource::TextureView(&targets.ground_distance.view),
                wgpu::BindingResource::TextureView(&targets.cone_distance.view),
            ],
        );
        let mut pass = targets.begin_relief_pass(encoder, timestamps);
        pass.set_pipeline(&self.overflow);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &map.group, &[]);
        pass.set_bind_group(2, &input, &[]);
        pass.draw(0..VOLUME_VERTICES, 0..1);
        pass.set_pipeline(&self.last);
        pass.draw(0..3, 0..1);
    }
}
