//! Draws the ground: distance along the view ray and normal.

use std::collections::HashMap;
use std::ops::Range;

use glam::IVec2;

use super::context::{PassContext, pass_number};
use super::shaders::GROUND;
use super::targets::{FAR_COLOR, reversed_depth};
use crate::gpu::{Gpu, PipelineParameters, color_target, shader_module};
use crate::scene::{Resident, SKIRT_M, TerrainSlot, nearest_first};
use crate::space::{Projection, TileId};
use crate::terrain::mesh_errors;

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
        let resident = context.resident;
        let draws = GroundDraws::new(resident, context.projection);
        let tiles = draws.nearest_first(context);
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
        let terrain = &resident.terrain;
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, context.frame, &[]);
        pass.set_bind_group(1, context.city, &[]);
        pass.set_index_buffer(terrain.indices.buffer.slice(..), wgpu::IndexFormat::Uint32);
        for (slot, mesh) in tiles {
            let Some(record) = terrain.record_of(slot) else {
                continue;
            };
            for part in draws.parts(resident, slot, mesh) {
                pass.draw_indexed(part, 0, record..record + 1);
            }
        }
    }
}

/// Which mesh of every resident tile is drawn.
struct GroundDraws {
    /// By slot.
    meshes: HashMap<u32, usize>,
}

/// The error of a terrain mesh that a pixel hides, pixels.
const MESH_ERROR_PIXELS: f64 = 0.125;

impl GroundDraws {
    /// The coarsest whose error a pixel hides.
    fn new(resident: &Resident, projection: &Projection) -> Self {
        let eye = projection.pose.eye;
        let pixel_angle = 2.0 * projection.tan_half_fov().y / f64::from(projection.size[1]);
        let mesh_of = |slot: &TerrainSlot| {
            let bounds = resident.tiles.grid.tile_bounds(slot.tile);
            let above = (eye.z - f64::from(slot.range[1])).max(0.0);
            let distance = bounds.distance_to(eye.truncate()).hypot(above);
            let hidden = MESH_ERROR_PIXELS * pixel_angle * distance;
            let is_hidden = |factor: &f64| factor * resident.terrain_error_m <= hidden;
            let coarsest = mesh_errors(slot.tile.level).iter().rposition(is_hidden);
            coarsest.unwrap_or(0).min(slot.meshes.len() - 1)
        };
        let slots = resident.ground_cover().iter();
        let meshes = slots.filter_map(|&slot| Some((slot, mesh_of(resident.terrain.slot(slot)?))));
        Self {
            meshes: meshes.collect(),
        }
    }

    /// Slots and meshes of the tiles in view.
    fn nearest_first(&self, context: &PassContext<'_>) -> Vec<(u32, usize)> {
        let grid = &context.resident.tiles.grid;
        let in_view = |&slot: &u32| {
            let tile = context.resident.terrain.slot(slot)?;
            // Down to where skirts hang.
            let skirt = f64::from(SKIRT_M) * f64::from(1_u32 << tile.tile.level);
            let [min, max] = tile.range.map(f64::from);
            let sees = (context.frustum).sees(&grid.tile_bounds(tile.tile), min - skirt, max);
            sees.then_some((slot, tile.tile))
        };
        let slots: Vec<(u32, TileId)> = (context.resident.ground_cover().iter())
            .filter_map(in_view)
            .collect();
        let tiles: Vec<TileId> = slots.iter().map(|&(_, tile)| tile).collect();
        let order = nearest_first(grid, &tiles, context.projection.pose.eye.truncate());
        order
            .into_iter()
            .map(|index| slots[index].0)
            .filter_map(|slot| Some((slot, *self.meshes.get(&slot)?)))
            .collect()
    }

    /// A tile's surface, and its skirts towards neighbours of which another level or another mesh is drawn.
    fn parts(&self, resident: &Resident, slot: u32, mesh: usize) -> Vec<Range<u32>> {
        let Some(tile) = resident.terrain.slot(slot) else {
            return Vec::new();
        };
        let indices = &tile.meshes[mesh];
        let id = tile.tile;
        let first = IVec2::new((id.x << id.level) as i32, (id.y << id.level) as i32);
        let size = 1 << id.level;
        let beside = [
            IVec2::new(0, -1),
            IVec2::new(size, 0),
            IVec2::new(0, size),
            IVec2::new(-1, 0),
        ];
        let has_skirt = |offset: &IVec2| {
            let (level, other) = resident.tiles.ground_slot_over(first + *offset);
            other.is_some_and(|other| level != id.level || self.meshes.get(&other) != Some(&mesh))
        };
        let skirts = beside
            .iter()
            .zip(&indices.skirts)
            .filter(|(offset, _)| has_skirt(offset));
        std::iter::once(indices.surface.clone())
            .chain(skirts.map(|(_, skirt)| skirt.clone()))
            .collect()
    }
}
