//! Draws the buildings by the method of KR 10-0738500: the building map as a displacement map, searched in slices
//! (`shaders/relief/search.wgsl` tells how). For fidelity to the source and comparison; `exact` is never wrong where this is.

use glam::IVec2;

use super::context::{PassContext, pass_number};
use super::shaders::SEARCH;
use super::targets::{ReliefTargets, relief_target_states};
use crate::gpu::{BySize, FLOAT, Gpu, PipelineParameters, shader_module, texture};
use crate::scene::nearest_first;
use crate::space::TileId;

/// Vertices of a tile's volume: six faces of two triangles.
const VOLUME_VERTICES: u32 = 36;

/// The pipeline.
pub struct SearchPass {
    pipeline: wgpu::RenderPipeline,
    input_layout: wgpu::BindGroupLayout,
    input: BySize<wgpu::BindGroup>,
}

impl SearchPass {
    /// Group 2: distance of the ground.
    pub const INPUT: [wgpu::BindingType; 1] = [texture(FLOAT)];

    /// For the layouts of groups 0 and 1.
    pub fn new(gpu: &Gpu, [frame, city]: [&wgpu::BindGroupLayout; 2]) -> Self {
        let module = shader_module(gpu, &SEARCH);
        let input_layout = gpu.layout("search input", &Self::INPUT);
        Self {
            pipeline: gpu.pipeline(&PipelineParameters {
                label: "search",
                module: &module,
                layouts: &[frame, city, &input_layout],
                vertex: "vs",
                buffers: &[],
                primitive: wgpu::PrimitiveState {
                    // Faces that look away from the viewer: they cover the volume also from inside it.
                    cull_mode: Some(wgpu::Face::Front),
                    ..Default::default()
                },
                // Tiles lie over one another in their order alone.
                depth: Some(wgpu::DepthStencilState {
                    format: wgpu::TextureFormat::Depth32Float,
                    depth_write_enabled: Some(false),
                    depth_compare: Some(wgpu::CompareFunction::Always),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                targets: &relief_target_states(),
            }),
            input_layout,
            input: BySize::default(),
        }
    }

    /// Binds the targets of a new size.
    pub fn bind(&mut self, gpu: &Gpu, targets: &ReliefTargets) {
        let resources = [targets.ground_distance.binding()];
        let layout = &self.input_layout;
        self.input
            .select(targets.size, || gpu.group("search input", layout, &resources));
    }

    /// Encodes the pass: the tiles in view, the farthest first.
    pub fn encode(&self, context: &mut PassContext<'_>) {
        let tiles = &context.resident.tiles;
        let grid = &tiles.grid;
        let [low, high] = [tiles.bounds.min_ground, tiles.bounds.max_roof].map(f64::from);
        let is_seen = |tile: &TileId| context.frustum.sees(&grid.tile_bounds(*tile), low, high);
        let seen: Vec<TileId> = grid.tiles().filter(is_seen).collect();
        let order = nearest_first(grid, &seen, context.projection.pose.eye.truncate());
        let (targets, band) = (context.targets, context.band);
        let timestamps = context.timer.pass(pass_number::BUILDINGS);
        let mut pass = targets.begin_buildings_pass(context.encoder, band, timestamps);
        if !band.confine(&mut pass, targets.size) {
            return;
        }
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, context.frame, &[]);
        pass.set_bind_group(1, context.city, &[]);
        pass.set_bind_group(2, self.input.current(), &[]);
        for index in order.into_iter().rev() {
            let place = IVec2::new(seen[index].x as i32, seen[index].y as i32);
            let instance = place.y as u32 * grid.columns + place.x as u32;
            pass.draw(0..VOLUME_VERTICES, instance..instance + 1);
        }
    }
}
