//! Pipelines that lay light on a target, with one uniform and one filtered image.

/// How.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Laid {
    /// It adds up.
    Added,
    /// It hides what lies below by its alpha.
    Over,
}

/// A pipeline (entries `vs` and `fs`) whose fragments lie on the target; its layout is the shader's own.
pub fn added_pipeline(
    gpu: &crate::gpu::Gpu,
    module: &wgpu::ShaderModule,
    format: wgpu::TextureFormat,
    buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
    topology: wgpu::PrimitiveTopology,
    laid: Laid,
) -> wgpu::RenderPipeline {
    let blend = |src_factor, dst_factor| wgpu::BlendComponent {
        src_factor,
        dst_factor,
        operation: wgpu::BlendOperation::Add,
    };
    let below = match laid {
        Laid::Added => wgpu::BlendFactor::One,
        Laid::Over => wgpu::BlendFactor::OneMinusSrcAlpha,
    };
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("added light"),
            layout: None,
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
                    format,
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

/// Group 0 of such a pipeline: uniform, image, sampler.
pub fn picture_group(
    gpu: &crate::gpu::Gpu,
    pipeline: &wgpu::RenderPipeline,
    uniforms: &wgpu::Buffer,
    image: &wgpu::TextureView,
    sampler: &wgpu::Sampler,
) -> wgpu::BindGroup {
    let resources = [
        uniforms.as_entire_binding(),
        wgpu::BindingResource::TextureView(image),
        wgpu::BindingResource::Sampler(sampler),
    ];
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("added light"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    })
}
