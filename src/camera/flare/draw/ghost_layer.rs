//! The ghosts' triangles on the device.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

use super::resources::{Blending, Resources};
use crate::camera::flare::{Aperture, FlareMesh, FlareVertex};
use crate::camera::shaders::GHOST;
use crate::gpu::{Gpu, Uniform, empty_buffer, filled_texture, shader_module};

/// Layout of `FlareFrame` in `shaders/camera/ghost.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct FlareFrame {
    pub half_mm: [f32; 2],
    pub mask_extent: f32,
    pub padding_a: f32,
    pub irradiance: [f32; 3],
    pub padding_b: f32,
}

/// Size of the aperture's mask, texels.
const MASK_SIZE: u32 = 512;
/// Half the mask's side in radii of the stop: beyond it no light passes.
const MASK_EXTENT: f64 = 1.1;
/// Most vertices in one buffer.
const MAX_VERTICES: u64 = 3_000_000;

/// Triangles of one buffer that are drawn with one pipeline.
struct Draw {
    blending: Blending,
    buffer: usize,
    vertices: Range<u32>,
}

/// Pipelines, the aperture's mask, and vertex buffers that grow with the mesh.
pub struct GhostLayer {
    added: wgpu::RenderPipeline,
    masks: wgpu::RenderPipeline,
    frame: Option<FlareFrame>,
    uniform: Uniform<FlareFrame>,
    group: Option<wgpu::BindGroup>,
    buffers: Vec<wgpu::Buffer>,
    draws: Vec<Draw>,
}

impl GhostLayer {
    /// Compiles the pipelines.
    pub fn new(gpu: &Gpu, resources: &Resources) -> Self {
        let module = shader_module(gpu, &GHOST);
        let buffers = [wgpu::VertexBufferLayout {
            array_stride: size_of::<FlareVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &FlareVertex::ATTRIBUTES,
        }];
        let topology = wgpu::PrimitiveTopology::TriangleList;
        let pipeline = |blending| resources.pipeline(gpu, &module, &buffers, topology, blending);
        Self {
            added: pipeline(Blending::Added),
            masks: pipeline(Blending::Masks),
            frame: None,
            uniform: Uniform::new(gpu, "ghosts"),
            group: None,
            buffers: Vec::new(),
            draws: Vec::new(),
        }
    }

    /// Takes another aperture.
    pub fn set_aperture(&mut self, gpu: &Gpu, resources: &Resources, aperture: &Aperture) {
        let texels = aperture.mask(MASK_SIZE, MASK_EXTENT);
        let format = wgpu::TextureFormat::R8Unorm;
        let mask = filled_texture(gpu, "aperture", [MASK_SIZE; 2], format, &texels);
        self.group = Some(resources.group(gpu, self.uniform.binding(), &mask));
    }

    /// Says what the image spans to each side, millimetres, and the light's irradiance, linear sRGB. True when that is new.
    pub fn set_frame(&mut self, gpu: &Gpu, half_mm: [f64; 2], irradiance: [f64; 3]) -> bool {
        let frame = FlareFrame {
            half_mm: half_mm.map(|half| half as f32),
            mask_extent: MASK_EXTENT as f32,
            padding_a: 0.0,
            irradiance: irradiance.map(|channel| channel as f32),
            padding_b: 0.0,
        };
        if self.frame == Some(frame) {
            return false;
        }
        self.uniform.write(gpu, &frame);
        self.frame = Some(frame);
        true
    }

    /// Takes another mesh. Buffers are made anew only when one is too small, at least twice as large then.
    pub fn set_mesh(&mut self, gpu: &Gpu, mesh: &FlareMesh) {
        let vertex_bytes = size_of::<FlareVertex>() as u64;
        let capacity =
            (gpu.device.limits().max_buffer_size / vertex_bytes).min(MAX_VERTICES) as usize / 3 * 3;
        let mut parts: Vec<(Draw, &[FlareVertex])> = Vec::new();
        let (mut buffer_index, mut used) = (0, 0);
        for (blending, mut rest) in [
            (Blending::Added, mesh.added.as_slice()),
            (Blending::Masks, mesh.masks.as_slice()),
            (Blending::Added, mesh.above.as_slice()),
        ] {
            while !rest.is_empty() {
                if used == capacity {
                    (buffer_index, used) = (buffer_index + 1, 0);
                }
                let (part, after) = rest.split_at(rest.len().min(capacity - used));
                let draw = Draw {
                    blending,
                    buffer: buffer_index,
                    vertices: used as u32..(used + part.len()) as u32,
                };
                used += part.len();
                rest = after;
                parts.push((draw, part));
            }
        }
        for index in 0..=buffer_index {
            let needed = if index < buffer_index { capacity } else { used };
            let fits = self
                .buffers
                .get(index)
                .is_some_and(|buffer| buffer.size() >= needed as u64 * vertex_bytes);
            if needed == 0 || fits {
                continue;
            }
            let size = needed.next_power_of_two().min(capacity) as u64 * vertex_bytes;
            let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
            let larger = empty_buffer(gpu, "ghosts", size, usage);
            if index < self.buffers.len() {
                self.buffers[index] = larger;
            } else {
                self.buffers.push(larger);
            }
        }
        for (draw, part) in &parts {
            let offset = u64::from(draw.vertices.start) * vertex_bytes;
            gpu.queue
                .write_buffer(&self.buffers[draw.buffer], offset, bytemuck::cast_slice(part));
        }
        self.draws = parts.into_iter().map(|(draw, _)| draw).collect();
    }

    /// Draws them.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(group) = &self.group else { return };
        pass.set_bind_group(0, group, &[]);
        for draw in &self.draws {
            pass.set_pipeline(match draw.blending {
                Blending::Added => &self.added,
                Blending::Masks => &self.masks,
            });
            pass.set_vertex_buffer(0, self.buffers[draw.buffer].slice(..));
            pass.draw(draw.vertices.clone(), 0..1);
        }
    }
}
