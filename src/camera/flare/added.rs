//! Pipelines that add light to a target, with one uniform and one filtered image.

/// A pipeline (entries `vs` and `fs`) whose fragments add to the target; its layout is the shader's own.
pub fn added_pipeline(
    gpu: &crate::gpu::Gpu,
    module: &wgpu::ShaderModule,
    format: wgpu::TextureFormat,
    buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
    topology: wgpu::PrimitiveTopology,
) -> wgpu::RenderPipeline {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
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
                        color: add,
                        alpha: add,
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
