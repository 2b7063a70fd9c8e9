//! Draws the buildings as triangles.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

use super::bindings::{FLOAT, UNIFORM, group_of, layout_of, texture};
use super::mesh::{BuildingMesh, MeshBlock, MeshVertex};
use super::shaders::POLYGONS;
use super::targets::ReliefTargets;
use crate::gpu::{Gpu, GpuError, shader_module, uniform_buffer};
use crate::scene::Frustum;
use crate::space::View;

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Anchor {
    at: [f32; 4],
}

/// The mesh on the GPU and its pipeline.
pub struct PolygonsPass {
    pipeline: wgpu::RenderPipeline,
    anchor_layout: wgpu::BindGroupLayout,
    input_layout: wgpu::BindGroupLayout,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    blocks: Vec<MeshBlock>,
    origin: DVec3,
}

impl PolygonsPass {
    /// Uploads a mesh whose positions count from `origin`.
    pub fn new(
        gpu: &Gpu,
        frame_layout: &wgpu::BindGroupLayout,
        mesh: &BuildingMesh,
        origin: DVec3,
    ) -> Result<Self, GpuError> {
        let module = shader_module(gpu, &POLYGONS);
        let anchor_layout = layout_of(gpu, "anchor", &[UNIFORM]);
        let input_layout = layout_of(gpu, "relief input", &[texture(FLOAT, false)]);
        let layout = gpu
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("polygons"),
                bind_group_layouts: &[Some(frame_layout), Some(&anchor_layout), Some(&input_layout)],
                immediate_size: 0,
            });
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Uint32, 3 => Uint32];
        let pipeline = gpu
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("polygons"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vs"),
                    compilation_options: Default::default(),
                    buffers: &[Some(wgpu::VertexBufferLayout {
                        array_stride: size_of::<MeshVertex>() as u64,
                        step_mode: wgpu::VertexStepMode::Vertex,
                        attributes: &attributes,
                    })],
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
                    targets: &super::targets::relief_target_states(),
                }),
                multiview_mask: None,
                cache: None,
            });
        let buffer = |label: &'static str, bytes: &[u8], usage| {
            gpu.require(label, bytes.len() as u64, gpu.device.limits().max_buffer_size)?;
            Ok(gpu.device.create_buffer_init(&BufferInitDescriptor {
                label: Some(label),
                contents: if bytes.is_empty() { &[0; 32] } else { bytes },
                usage,
            }))
        };
        Ok(Self {
            pipeline,
            anchor_layout,
            input_layout,
            vertices: buffer(
                "building polygons",
                bytemuck::cast_slice(&mesh.vertices),
                wgpu::BufferUsages::VERTEX,
            )?,
            indices: buffer(
                "building polygons",
                bytemuck::cast_slice(&mesh.indices),
                wgpu::BufferUsages::INDEX,
            )?,
            blocks: mesh.blocks.clone(),
            origin,
        })
    }

    /// Encodes the pass: the blocks in view, the nearest first.
    #[allow(clippy::too_many_arguments)]
    pub fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &View,
        frustum: &Frustum,
        frame: &wgpu::BindGroup,
        targets: &ReliefTargets,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let at = (self.origin - view.eye).as_vec3().extend(0.0).to_array();
        let anchor = uniform_buffer(gpu, "anchor", &Anchor { at });
        let anchor = group_of(
            gpu,
            "anchor",
            &self.anchor_layout,
            vec![anchor.as_entire_binding()],
        );
        let input = group_of(
            gpu,
            "relief input",
            &self.input_layout,
            vec![wgpu::BindingResource::TextureView(&targets.ground_distance.view)],
        );
        let mut pass = targets.begin_relief_pass(encoder, timestamps);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &anchor, &[]);
        pass.set_bind_group(2, &input, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        let mut blocks: Vec<&MeshBlock> = self
            .blocks
            .iter()
            .filter(|block| frustum.sees(&block.bounds, block.range[0], block.range[1]))
            .collect();
        let eye = view.eye.truncate();
        blocks.sort_by(|a, b| {
            let away = |block: &MeshBlock| block.bounds.centre().distance_squared(eye);
            away(a).total_cmp(&away(b))
        });
        for block in blocks {
            pass.draw_indexed(block.indices.clone(), 0, 0..1);
        }
    }
}
