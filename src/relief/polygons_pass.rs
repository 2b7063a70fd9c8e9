//! Draws the buildings as triangles.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::building_mesh::{BuildingMesh, MeshBlock, MeshVertex};
use super::context::{PassContext, pass_number};
use super::shaders::POLYGONS;
use super::targets::{ReliefTargets, relief_target_states, reversed_depth};
use crate::gpu::{
    BySize, FLOAT, Gpu, GpuError, PipelineParameters, UNIFORM, Uniform, geometry_buffer, shader_module,
    texture,
};

/// Layout of `Anchor` in `shaders/relief/polygons.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Anchor {
    /// The mesh's origin, eye-relative, metres.
    pub at: [f32; 4],
}

/// The mesh on the GPU and its pipeline.
pub struct PolygonsPass {
    pipeline: wgpu::RenderPipeline,
    anchor: Uniform<Anchor>,
    anchor_group: wgpu::BindGroup,
    input_layout: wgpu::BindGroupLayout,
    input: BySize<wgpu::BindGroup>,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    blocks: Vec<MeshBlock>,
    origin: DVec3,
}

impl PolygonsPass {
    /// Group 1: the mesh's origin.
    pub const ANCHOR: [wgpu::BindingType; 1] = [UNIFORM];
    /// Group 2: distance of the ground.
    pub const INPUT: [wgpu::BindingType; 1] = [texture(FLOAT)];

    /// Uploads a mesh whose positions count from `origin`.
    ///
    /// # Errors
    /// When the device cannot hold it.
    pub fn new(
        gpu: &Gpu,
        frame_layout: &wgpu::BindGroupLayout,
        mesh: &BuildingMesh,
        origin: DVec3,
    ) -> Result<Self, GpuError> {
        let module = shader_module(gpu, &POLYGONS);
        let anchor_layout = gpu.layout("anchor", &Self::ANCHOR);
        let input_layout = gpu.layout("polygons input", &Self::INPUT);
        let pipeline = gpu.pipeline(&PipelineParameters {
            label: "polygons",
            module: &module,
            layouts: &[frame_layout, &anchor_layout, &input_layout],
            vertex: "vs",
            buffers: &[wgpu::VertexBufferLayout {
                array_stride: size_of::<MeshVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &MeshVertex::ATTRIBUTES,
            }],
            primitive: wgpu::PrimitiveState {
                cull_mode: Some(wgpu::Face::Back),
                ..Default::default()
            },
            depth: Some(reversed_depth()),
            targets: &relief_target_states(),
        });
        let anchor = Uniform::new(gpu, "anchor");
        let label = "building polygons";
        Ok(Self {
            pipeline,
            anchor_group: gpu.group("anchor", &anchor_layout, &[anchor.binding()]),
            anchor,
            input_layout,
            input: BySize::default(),
            vertices: geometry_buffer(gpu, label, &mesh.vertices, wgpu::BufferUsages::VERTEX)?,
            indices: geometry_buffer(gpu, label, &mesh.indices, wgpu::BufferUsages::INDEX)?,
            blocks: mesh.blocks.clone(),
            origin,
        })
    }

    /// Binds the targets of a new size.
    pub fn bind(&mut self, gpu: &Gpu, targets: &ReliefTargets) {
        let resources = [targets.ground_distance.binding()];
        let layout = &self.input_layout;
        self.input
            .select(targets.size, || gpu.group("polygons input", layout, &resources));
    }

    /// Encodes the pass: the blocks in view, the nearest first.
    pub fn encode(&self, context: &mut PassContext<'_>) {
        let eye = context.projection.pose.eye;
        let at = (self.origin - eye).as_vec3().extend(0.0).to_array();
        self.anchor.write(context.gpu, &Anchor { at });
        let timestamps = context.timer.pass(pass_number::BUILDINGS);
        let mut pass = context
            .targets
            .begin_buildings_pass(context.encoder, context.band, timestamps);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, context.frame, &[]);
        pass.set_bind_group(1, &self.anchor_group, &[]);
        pass.set_bind_group(2, self.input.current(), &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        let is_seen = |block: &&MeshBlock| {
            context
                .frustum
                .sees(&block.bounds, block.range[0], block.range[1])
        };
        let mut blocks: Vec<&MeshBlock> = self.blocks.iter().filter(is_seen).collect();
        let away = |block: &MeshBlock| block.bounds.centre().distance_squared(eye.truncate());
        blocks.sort_by(|a, b| away(a).total_cmp(&away(b)));
        for block in blocks {
            pass.draw_indexed(block.indices.clone(), 0, 0..1);
        }
    }
}
