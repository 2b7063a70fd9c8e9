//! Adds a flare to a picture.

use bytemuck::{Pod, Zeroable};
use wgpu::util::{BufferInitDescriptor, DeviceExt, TextureDataOrder};

use super::{Aperture, FlareMesh, FlareVertex, Laid, added_pipeline, picture_group};
use crate::camera::shaders::FLARE;
use crate::gpu::{Gpu, Target, shader_module, uniform_buffer};

/// Layout of `FlareFrame` in `shaders/camera/flare.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct FlareFrame {
    pub half_mm: [f32; 2],
    pub mask_reach: f32,
    pub scale: f32,
}

/// Side of the aperture's mask, texels.
const MASK_SIDE: u32 = 512;
/// Half the side of the mask in radii of the stop: beyond it no light passes.
const MASK_REACH: f64 = 1.1;

/// Most corners in one buffer.
const MAX_VERTICES: u64 = 3_000_000;

/// The pipelines with an aperture.
pub struct FlarePass {
    added: wgpu::RenderPipeline,
    over: wgpu::RenderPipeline,
    mask: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

impl FlarePass {
    /// For a target's format and an aperture.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, aperture: &Aperture) -> Self {
        let module = shader_module(gpu, &FLARE);
        let attributes = wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Float32x2, 3 => Float32x3, 4 => Float32];
        let buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<FlareVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        })];
        let topology = wgpu::PrimitiveTopology::TriangleList;
        let pipeline = |laid| added_pipeline(gpu, &module, format, &buffers, topology, laid);
        let mask = gpu.device.create_texture_with_data(
            &gpu.queue,
            &wgpu::TextureDescriptor {
                label: Some("aperture"),
                size: wgpu::Extent3d {
                    width: MASK_SIDE,
                    height: MASK_SIDE,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::R8Unorm,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            },
            TextureDataOrder::LayerMajor,
            &aperture.mask(MASK_SIDE, MASK_REACH),
        );
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("aperture"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self {
            added: pipeline(Laid::Added),
            over: pipeline(Laid::Over),
            mask: mask.create_view(&wgpu::TextureViewDescriptor::default()),
            sampler,
        }
    }

    /// Lays a flare on what `target` holds. The picture spans `half_mm` millimetres of the sensor to each side; `scale` is the
    /// visible share of the source.
    pub fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &Target,
        mesh: &FlareMesh,
        half_mm: [f64; 2],
        scale: f64,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let frame = FlareFrame {
            half_mm: half_mm.map(|side| side as f32),
            mask_reach: MASK_REACH as f32,
            scale: scale as f32,
        };
        let uniforms = uniform_buffer(gpu, "flare", &frame);
        // A buffer holds so many triangles at a time.
        let most = (gpu.device.limits().max_buffer_size / size_of::<FlareVertex>() as u64).min(MAX_VERTICES);
        let most = most as usize / 3 * 3;
        let mut draws = Vec::new();
        for (pipeline, vertices) in [
            (&self.added, &mesh.added),
            (&self.over, &mesh.covers),
            (&self.added, &mesh.above),
        ] {
            let group = picture_group(gpu, pipeline, &uniforms, &self.mask, &self.sampler);
            for part in vertices.chunks(most) {
                let buffer = gpu.device.create_buffer_init(&BufferInitDescriptor {
                    label: Some("ghosts"),
                    contents: bytemuck::cast_slice(part),
                    usage: wgpu::BufferUsages::VERTEX,
                });
                draws.push((pipeline, group.clone(), buffer, part.len() as u32));
            }
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("flare"),
            color_attachments: &[target.loaded()],
            timestamp_writes: timestamps,
            ..Default::default()
        });
        for (pipeline, group, buffer, count) in &draws {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..*count, 0..1);
        }
    }
}
