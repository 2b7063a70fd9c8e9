//! Draws the buildings out of the building map: overflow faces on the border of the tiles' volume, an exact
//! walk per pixel, tile after tile, the nearest first (`shaders/relief/exact.wgsl` tells how).

use super::context::{PassContext, pass_number};
use super::shaders::EXACT;
use super::targets::{ReliefTargets, relief_target_states, reversed_depth};
use crate::gpu::{BySize, FLOAT, Gpu, PipelineParameters, shader_module, texture};

/// The pipelines.
pub struct ExactPass {
    /// Faces of the tiles' volume.
    overflow: wgpu::RenderPipeline,
    /// The face behind all others.
    last: wgpu::RenderPipeline,
    input_layout: wgpu::BindGroupLayout,
    input: BySize<wgpu::BindGroup>,
}

/// Vertices of the tiles' volume: six faces of two triangles.
const VOLUME_VERTICES: u32 = 36;

impl ExactPass {
    /// Group 2: distance of the ground, distance without a building.
    pub const INPUT: [wgpu::BindingType; 2] = [texture(FLOAT), texture(FLOAT)];

    /// For the layouts of groups 0 and 1.
    pub fn new(gpu: &Gpu, [frame, city]: [&wgpu::BindGroupLayout; 2]) -> Self {
        let module = shader_module(gpu, &EXACT);
        let input_layout = gpu.layout("exact input", &Self::INPUT);
        let pipeline = |vertex, cull_mode| {
            gpu.pipeline(&PipelineParameters {
                label: "exact",
                module: &module,
                layouts: &[frame, city, &input_layout],
                vertex,
                buffers: &[],
                primitive: wgpu::PrimitiveState {
                    cull_mode,
                    ..Default::default()
                },
                depth: Some(reversed_depth()),
                targets: &relief_target_states(),
            })
        };
        // Faces that look away from the viewer: they cover the volume also from inside it.
        let overflow = pipeline("vs_overflow", Some(wgpu::Face::Front));
        let last = pipeline("vs_last", None);
        Self {
            overflow,
            last,
            input_layout,
            input: BySize::default(),
        }
    }

    /// Binds the targets of a new size.
    pub fn bind(&mut self, gpu: &Gpu, targets: &ReliefTargets) {
        let resources = [targets.ground_distance.binding(), targets.cone_distance.binding()];
        let layout = &self.input_layout;
        self.input
            .select(targets.size, || gpu.group("exact input", layout, &resources));
    }

    /// Encodes the pass: the end of the buildings' time.
    pub fn encode(&self, context: &mut PassContext<'_>) {
        let timestamps = context.timer.pass_end(pass_number::BUILDINGS);
        let (targets, band) = (context.targets, context.band);
        let mut pass = targets.begin_buildings_pass(context.encoder, band, timestamps);
        if !band.confine(&mut pass, targets.size) {
            return;
        }
        pass.set_pipeline(&self.overflow);
        pass.set_bind_group(0, context.frame, &[]);
        pass.set_bind_group(1, context.city, &[]);
        pass.set_bind_group(2, self.input.current(), &[]);
        pass.draw(0..VOLUME_VERTICES, 0..1);
        pass.set_pipeline(&self.last);
        pass.draw(0..3, 0..1);
    }
}
