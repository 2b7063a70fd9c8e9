//! Draws an image over the whole window: the city's, and the panel over it. On a software device a tenth of what a user
//! interface's own painter takes for the same pixels.

use crate::gpu::{
    FILTERED, Gpu, PipelineParameters, SAMPLER, ShaderSource, UNIFORM, Uniform, shader_file, shader_module,
    texture,
};

/// The shader.
pub const SCREEN: ShaderSource = ShaderSource {
    name: "viewer/blit.wgsl",
    constants: &[],
    files: &[shader_file!("fullscreen.wgsl"), shader_file!("viewer/blit.wgsl")],
};

/// The pipeline and the image that it draws.
pub struct Blit {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    window: Uniform<[f32; 4]>,
    /// The image's group and view: bound anew for another view.
    image: Option<(wgpu::BindGroup, wgpu::TextureView)>,
}

impl Blit {
    /// Group 0: the image, its sampler, the window's size.
    pub const INPUT: [wgpu::BindingType; 3] = [texture(FILTERED), SAMPLER, UNIFORM];

    /// For a surface's colour target state.
    pub fn new(gpu: &Gpu, target: Option<wgpu::ColorTargetState>) -> Self {
        let module = shader_module(gpu, &SCREEN);
        let layout = gpu.layout("screen", &Self::INPUT);
        let targets = [target];
        Self {
            pipeline: gpu.pipeline(&PipelineParameters::fullscreen(
                "screen",
                &module,
                &[&layout],
                &targets,
            )),
            layout,
            sampler: gpu.linear_sampler("screen", false),
            window: Uniform::new(gpu, "screen"),
            image: None,
        }
    }

    /// The image of the next frame, for a window of `window` pixels.
    pub fn bind(&mut self, gpu: &Gpu, view: &wgpu::TextureView, window: [u32; 2]) {
        let [width, height] = window.map(|count| count as f32);
        self.window.write(gpu, &[width, height, 0.0, 0.0]);
        if self.image.as_ref().is_some_and(|(_, known)| known == view) {
            return;
        }
        let resources = [
            wgpu::BindingResource::TextureView(view),
            wgpu::BindingResource::Sampler(&self.sampler),
            self.window.binding(),
        ];
        self.image = Some((gpu.group("screen", &self.layout, &resources), view.clone()));
    }

    /// Draws it.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some((group, _)) = &self.image else { return };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}
