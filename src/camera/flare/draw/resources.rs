//! The device's resources that drawing a flare needs: one layout (uniform, image, sampler) serves ghosts and sprites.

use wgpu::util::{DeviceExt, TextureDataOrder};

use crate::gpu::Gpu;

/// How the fragments of a pipeline meet what lies below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blending {
    /// They add up.
    Added,
    /// They mask what lies below by their alpha, and add.
    Masks,
}

/// What pipelines and groups of this room have in common.
pub struct Resources {
    /// Group 0: uniform, filtered image, sampler.
    pub layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    format: wgpu::TextureFormat,
}

impl Resources {
    /// For a target's format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let types = [
            wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        ];
        let entries: Vec<_> = (0..)
            .zip(types)
            .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty,
                count: None,
            })
            .collect();
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("flare"),
                entries: &entries,
            });
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("flare"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self {
            layout,
            sampler,
            format,
        }
    }

    /// A pipeline with the entries `vs` and `fs`.
    pub fn pipeline(
        &self,
        gpu: &Gpu,
        module: &wgpu::ShaderModule,
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        topology: wgpu::PrimitiveTopology,
        blending: Blending,
    ) -> wgpu::RenderPipeline {
        let blend = |src_factor, dst_factor| wgpu::BlendComponent {
            src_factor,
            dst_factor,
            operation: wgpu::BlendOperation::Add,
        };
        let below = match blending {
            Blending::Added => wgpu::BlendFactor::One,
            Blending::Masks => wgpu::BlendFactor::OneMinusSrcAlpha,
        };
        let layout = gpu
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("flare"),
                bind_group_layouts: &[Some(&self.layout)],
                immediate_size: 0,
            });
        gpu.device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("flare"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module,
                    entry_point: Some("vs"),
                    compilation_options: Default::default(),
                    buffers,
                },
                primitive: wgpu::PrimitiveState {
                    topology,
                    ..Default::default()
                },
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module,
                    entry_point: Some("fs"),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: self.format,
                        blend: Some(wgpu::BlendState {
                            color: blend(wgpu::BlendFactor::One, below),
                            alpha: blend(wgpu::BlendFactor::Zero, wgpu::BlendFactor::One),
                        }),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
    }

    /// Group 0.
    pub fn group(&self, gpu: &Gpu, uniform: &wgpu::Buffer, image: &wgpu::TextureView) -> wgpu::BindGroup {
        let resources = [
            uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(image),
            wgpu::BindingResource::Sampler(&self.sampler),
        ];
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("flare"),
            layout: &self.layout,
            entries: &entries,
        })
    }
}

/// A texture of one level filled from memory, row by row.
pub fn filled_texture<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    texels: &[T],
) -> wgpu::TextureView {
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(texels),
    );
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// An unwritten buffer that can be written again and again.
pub fn buffer(gpu: &Gpu, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
