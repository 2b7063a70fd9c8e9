//! Render pipelines: what all passes have in common is written once.

use super::Gpu;

/// What makes one render pipeline differ from another.
pub struct PipelineParameters<'a> {
    /// For the device's messages.
    pub label: &'static str,
    /// The compiled shader.
    pub module: &'a wgpu::ShaderModule,
    /// Layouts of groups 0, 1, ..
    pub layouts: &'a [&'a wgpu::BindGroupLayout],
    /// Entry of the vertex stage.
    pub vertex: &'static str,
    /// Vertex buffers; none where vertices are made from their index.
    pub buffers: &'a [wgpu::VertexBufferLayout<'a>],
    /// Topology and culling.
    pub primitive: wgpu::PrimitiveState,
    /// Depth test.
    pub depth: Option<wgpu::DepthStencilState>,
    /// Formats and blending of the targets.
    pub targets: &'a [Option<wgpu::ColorTargetState>],
}

impl<'a> PipelineParameters<'a> {
    /// One triangle over the whole target (`shaders/fullscreen.wgsl`).
    pub fn fullscreen(
        label: &'static str,
        module: &'a wgpu::ShaderModule,
        layouts: &'a [&'a wgpu::BindGroupLayout],
        targets: &'a [Option<wgpu::ColorTargetState>],
    ) -> Self {
        Self {
            label,
            module,
            layouts,
            vertex: "vs_fullscreen",
            buffers: &[],
            primitive: wgpu::PrimitiveState::default(),
            depth: None,
            targets,
        }
    }
}

impl Gpu {
    /// Makes a pipeline whose fragment entry is `fs`.
    pub fn pipeline(&self, parameters: &PipelineParameters<'_>) -> wgpu::RenderPipeline {
        let layouts: Vec<_> = parameters.layouts.iter().map(|&layout| Some(layout)).collect();
        let buffers: Vec<_> = parameters.buffers.iter().cloned().map(Some).collect();
        self.count_creation();
        let layout = self
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(parameters.label),
                bind_group_layouts: &layouts,
                immediate_size: 0,
            });
        self.device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(parameters.label),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: parameters.module,
                    entry_point: Some(parameters.vertex),
                    compilation_options: Default::default(),
                    buffers: &buffers,
                },
                primitive: parameters.primitive,
                depth_stencil: parameters.depth.clone(),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: parameters.module,
                    entry_point: Some("fs"),
                    compilation_options: Default::default(),
                    targets: parameters.targets,
                }),
                multiview_mask: None,
                cache: None,
            })
    }

    /// Makes a compute pipeline with the entry `cs` and one group.
    pub fn compute_pipeline(
        &self,
        label: &str,
        module: &wgpu::ShaderModule,
        layout: &wgpu::BindGroupLayout,
    ) -> wgpu::ComputePipeline {
        self.count_creation();
        let layout = self
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &[Some(layout)],
                immediate_size: 0,
            });
        self.device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                module,
                entry_point: Some("cs"),
                compilation_options: Default::default(),
                cache: None,
            })
    }
}
