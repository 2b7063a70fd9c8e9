//! The part of an image's flare that a window shows (`shaders/output/flare_window.wgsl` tells how).

use bytemuck::{Pod, Zeroable};
use glam::Vec2;

use crate::gpu::{
    FLOAT, Gpu, PipelineParameters, ShaderSource, Target, UNIFORM, Uniform, color_target, shader_file,
    shader_module, texture,
};
use crate::space::ImageWindow;

/// The shader.
pub const FLARE_WINDOW: ShaderSource = ShaderSource {
    name: "output/flare_window.wgsl",
    constants: &[],
    files: &[
        shader_file!("fullscreen.wgsl"),
        shader_file!("output/flare_window.wgsl"),
    ],
};

/// Layout of `FlareWindow` in `shaders/output/flare_window.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct FlareWindowFrame {
    pub first: [f32; 2],
    pub texels: [f32; 2],
}

/// The pipeline, and what the last window shows.
pub struct FlareWindow {
    pipeline: wgpu::RenderPipeline,
    frame: Uniform<FlareWindowFrame>,
    group: wgpu::BindGroup,
    target: Target,
}

impl FlareWindow {
    /// Group 0: where the window lies, the flare of the whole image.
    pub const INPUT: [wgpu::BindingType; 2] = [UNIFORM, texture(FLOAT)];

    /// For windows of `size` pixels of what `flare` will hold.
    pub fn new(gpu: &Gpu, flare: &Target, size: [u32; 2]) -> Self {
        let format = flare.texture.format();
        let layout = gpu.layout("flare window", &Self::INPUT);
        let frame = Uniform::new(gpu, "flare window");
        let module = shader_module(gpu, &FLARE_WINDOW);
        let targets = [color_target(format)];
        Self {
            pipeline: gpu.pipeline(&PipelineParameters::fullscreen(
                "flare window",
                &module,
                &[&layout],
                &targets,
            )),
            group: gpu.group("flare window", &layout, &[frame.binding(), flare.binding()]),
            frame,
            target: Target::new(gpu, "flare window", size, format),
        }
    }

    /// Says which window is shown, of an image of `image` pixels whose flare has `flare` pixels.
    pub fn show(&self, gpu: &Gpu, window: &ImageWindow, [image, flare]: [[u32; 2]; 2]) {
        let [image, flare] = [image, flare].map(|size| Vec2::from_array(size.map(|side| side as f32)));
        self.frame.write(
            gpu,
            &FlareWindowFrame {
                first: window.first.map(|first| first as f32),
                texels: (flare / image).to_array(),
            },
        );
    }

    /// What the window shows.
    pub fn target(&self) -> &Target {
        &self.target
    }

    /// Draws it.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("flare window"),
            color_attachments: &[self.target.cleared(wgpu::Color::TRANSPARENT)],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
