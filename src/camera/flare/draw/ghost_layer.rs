//! The ghosts' triangles on the device.

use std::ops::Range;

use glam::DVec2;

use super::ghost_frame::{FlareFrame, GhostRecord};
use super::guard_band::{guard_sides, set_guard_band};
use super::resources::{Blending, Resources};
use super::soft_levels::{SoftLevels, SoftPipelines, SoftTask};
use super::soft_masks::{IrisMasks, MIN_SOFTNESS};
use super::soft_plan::{ImageScale, SoftPlan, vertex_ranges};
use crate::camera::flare::ghost::GhostTriangles;
use crate::camera::flare::{Aperture, FlareMesh, FlareVertex};
use crate::camera::shaders::{GHOST, SOFT_GHOST};
use crate::gpu::{BySize, Gpu, Target, Uniform, empty_buffer, shader_module};

/// Most vertices in one buffer.
const MAX_VERTICES: u64 = 3_000_000;

/// Pipelines, the aperture's mask, and vertex buffers that grow with the mesh.
pub struct GhostLayer {
    added: wgpu::RenderPipeline,
    /// Softened in the iris.
    added_soft: wgpu::RenderPipeline,
    masks: wgpu::RenderPipeline,
    soft: SoftPipelines,
    frame: Option<FlareFrame>,
    uniform: Uniform<FlareFrame>,
    iris: Option<(IrisMasks, wgpu::BindGroup)>,
    levels: BySize<SoftLevels>,
    buffers: Vec<wgpu::Buffer>,
    /// Vertices in one buffer.
    capacity: usize,
    records: Option<wgpu::Buffer>,
    ghosts: Vec<GhostTriangles>,
    ranges: Vec<Range<usize>>,
    plan: Option<(ImageScale, SoftPlan)>,
    /// What hides the ghosts that add up, and what adds to what is left.
    over: [Range<usize>; 2],
}

impl GhostLayer {
    /// Compiles the pipelines.
    pub fn new(gpu: &Gpu, resources: &Resources) -> Self {
        let sharp = shader_module(gpu, &GHOST);
        let soft = shader_module(gpu, &SOFT_GHOST);
        let buffers = [
            wgpu::VertexBufferLayout {
                array_stride: size_of::<FlareVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &FlareVertex::ATTRIBUTES,
            },
            wgpu::VertexBufferLayout {
                array_stride: size_of::<GhostRecord>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &GhostRecord::ATTRIBUTES,
            },
        ];
        let pipeline = |module, blending| resources.ghost_pipeline(gpu, module, &buffers, blending);
        let vertex_bytes = size_of::<FlareVertex>() as u64;
        let capacity = (gpu.device.limits().max_buffer_size / vertex_bytes).min(MAX_VERTICES) / 3 * 3;
        Self {
            added: pipeline(&sharp, Blending::Added),
            added_soft: pipeline(&soft, Blending::Added),
            masks: pipeline(&sharp, Blending::Masks),
            soft: SoftPipelines::new(gpu, resources),
            frame: None,
            uniform: Uniform::new(gpu, "ghosts"),
            iris: None,
            levels: BySize::default(),
            buffers: Vec::new(),
            capacity: capacity as usize,
            records: None,
            ghosts: Vec::new(),
            ranges: Vec::new(),
            plan: None,
            over: [0..0, 0..0],
        }
    }

    /// Takes another aperture.
    pub fn set_aperture(&mut self, gpu: &Gpu, resources: &Resources, aperture: &Aperture) {
        let masks = IrisMasks::new(gpu, aperture);
        let group = resources.ghost_group(gpu, self.uniform.binding(), &masks);
        self.iris = Some((masks, group));
        // They look up the mask.
        self.levels.clear();
        self.frame = None;
    }

    /// Says what the image of `size` pixels spans to each side, millimetres, and the light's irradiance, linear sRGB. True when that
    /// is new.
    pub fn set_frame(
        &mut self,
        gpu: &Gpu,
        resources: &Resources,
        (size, half_mm): ([u32; 2], [f64; 2]),
        irradiance: [f64; 3],
    ) -> bool {
        let Some((masks, _)) = &self.iris else {
            return false;
        };
        let levels = self
            .levels
            .select(size, || SoftLevels::new(gpu, resources, size, masks));
        let frame = FlareFrame {
            half_mm: half_mm.map(|half| half as f32),
            centre_mm: [0.0; 2],
            irradiance: irradiance.map(|channel| channel as f32),
            padding: 0.0,
        };
        let scale = ImageScale {
            half_mm: DVec2::from_array(half_mm),
            size: DVec2::new(f64::from(size[0]), f64::from(size[1])),
            // In powers of two, so that a sun that is hidden bit by bit is not planned anew each time.
            max_white: 2_f64.powi(-(irradiance.iter().fold(1e-6_f64, |a, &b| a.max(b)).log2().ceil() as i32)),
        };
        let is_planned = self.plan.as_ref().is_some_and(|(known, _)| *known == scale);
        if self.frame == Some(frame) && is_planned {
            return false;
        }
        self.uniform.write(gpu, &frame.guarded(guard_sides(size)));
        levels.set_frame(gpu, &frame);
        self.frame = Some(frame);
        if !is_planned {
            let plan = SoftPlan::new(&self.ghosts, &scale, levels.max_level());
            let of_ghosts = self.ghosts.iter().zip(&plan.enlarged);
            let records: Vec<GhostRecord> = std::iter::once(GhostRecord::PLAIN)
                .chain(of_ghosts.map(|(ghost, enlarged)| GhostRecord {
                    centre_mm: enlarged.centre_mm.as_vec2().to_array(),
                    enlarged: enlarged.by.as_vec2().to_array(),
                    soft: ghost.in_iris.unwrap_or_default().map(|radius| radius as f32),
                }))
                .collect();
            let bytes = size_of_val(records.as_slice()) as u64;
            let buffer = grown(gpu, self.records.take(), bytes);
            gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&records));
            self.records = Some(buffer);
            self.plan = Some((scale, plan));
        }
        true
    }

    /// Takes another mesh. Buffers are made anew only when one is too small, at least twice as large then.
    pub fn set_mesh(&mut self, gpu: &Gpu, mesh: &FlareMesh) {
        let counts = [mesh.added.len(), mesh.masks.len(), mesh.above.len()];
        let total: usize = counts.iter().sum();
        let bytes_of = |vertices: usize| (vertices * size_of::<FlareVertex>()) as u64;
        for (index, start) in (0..total).step_by(self.capacity).enumerate() {
            let bytes = bytes_of(self.capacity.min(total - start));
            let known = (index < self.buffers.len()).then(|| self.buffers.remove(index));
            self.buffers.insert(index, grown(gpu, known, bytes));
        }
        let mut at = 0;
        for part in [&mesh.added, &mesh.masks, &mesh.above] {
            let mut rest = part.as_slice();
            while !rest.is_empty() {
                let (buffer, used) = (at / self.capacity, at % self.capacity);
                let (now, after) = rest.split_at(rest.len().min(self.capacity - used));
                gpu.queue
                    .write_buffer(&self.buffers[buffer], bytes_of(used), bytemuck::cast_slice(now));
                (at, rest) = (at + now.len(), after);
            }
        }
        self.over = [counts[0]..counts[0] + counts[1], counts[0] + counts[1]..total];
        self.ranges = vertex_ranges(&mesh.ghosts);
        self.ghosts.clone_from(&mesh.ghosts);
        self.plan = None;
    }

    /// Draws the ghosts that need not the image's own pixels, or are softened on the sensor, onto what `image` holds. `begin` is
    /// given to the first pass; what is left of it comes back.
    pub fn encode_soft<'a>(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        image: &Target,
        begin: Option<wgpu::RenderPassTimestampWrites<'a>>,
    ) -> Option<wgpu::RenderPassTimestampWrites<'a>> {
        let (Some(levels), Some((_, plan))) = (self.levels.current(), &self.plan) else {
            return begin;
        };
        let draw = |pass: &mut wgpu::RenderPass<'_>, ghosts: &[usize]| self.draw_ghosts(pass, ghosts);
        let task = SoftTask {
            pipelines: &self.soft,
            plan,
            image,
        };
        levels.encode(encoder, task, draw, begin)
    }

    /// Draws the ghosts that need the image's own pixels, and those that lie over others, in a pass onto `image`.
    pub fn draw_sharp(&self, pass: &mut wgpu::RenderPass<'_>, image: &Target) {
        let (Some((_, group)), Some(records)) = (&self.iris, &self.records) else {
            return;
        };
        pass.set_bind_group(0, group, &[]);
        set_guard_band(pass, image, guard_sides(image.size()));
        if let Some((_, plan)) = &self.plan {
            self.draw_ghosts(pass, &plan.in_iris[0]);
        }
        pass.set_vertex_buffer(1, records.slice(..));
        for (pipeline, range) in [&self.masks, &self.added].into_iter().zip(&self.over) {
            pass.set_pipeline(pipeline);
            self.draw_vertices(pass, range, 0);
        }
        image.show_whole(pass);
    }

    /// Draws ghosts by their numbers; their group is set.
    fn draw_ghosts(&self, pass: &mut wgpu::RenderPass<'_>, ghosts: &[usize]) {
        let Some(records) = &self.records else { return };
        pass.set_vertex_buffer(1, records.slice(..));
        let is_soft = |ghost: &&usize| {
            let in_iris = self.ghosts[**ghost].in_iris;
            in_iris.is_some_and(|[stop, _]| stop >= MIN_SOFTNESS)
        };
        let (soft, sharp): (Vec<usize>, Vec<usize>) = ghosts.iter().partition(is_soft);
        for (pipeline, ghosts) in [(&self.added, sharp), (&self.added_soft, soft)] {
            pass.set_pipeline(pipeline);
            for ghost in ghosts {
                // The first record is that of no ghost.
                self.draw_vertices(pass, &self.ranges[ghost], ghost as u32 + 1);
            }
        }
    }

    fn draw_vertices(&self, pass: &mut wgpu::RenderPass<'_>, range: &Range<usize>, record: u32) {
        let mut at = range.start;
        while at < range.end {
            let (buffer, from) = (at / self.capacity, at % self.capacity);
            let to = (from + range.end - at).min(self.capacity);
            pass.set_vertex_buffer(0, self.buffers[buffer].slice(..));
            pass.draw(from as u32..to as u32, record..record + 1);
            at += to - from;
        }
    }
}

/// A vertex buffer of at least so many bytes: the known one, or one that has room to grow.
fn grown(gpu: &Gpu, known: Option<wgpu::Buffer>, bytes: u64) -> wgpu::Buffer {
    match known {
        Some(buffer) if buffer.size() >= bytes => buffer,
        other => {
            let size = bytes
                .max(2 * other.map_or(0, |buffer| buffer.size()))
                .min(gpu.device.limits().max_buffer_size);
            let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
            empty_buffer(gpu, "ghosts", size, usage)
        }
    }
}
