//! Exposes and tone-maps the mean of an image's samples and what the lens adds (`shaders/camera/tone_map.wgsl` tells how).

use bytemuck::{Pod, Zeroable};

use super::shaders::TONE_MAP;
use crate::gpu::{
    BySize, FLOAT, Gpu, PipelineParameters, Target, UNIFORM, Uniform, color_target, shader_module, texture,
};

/// Layout of `Exposure` in `shaders/camera/tone_map.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Exposure {
    /// Factor from summed radiance to the display's linear 0..1.
    pub scale: f32,
    /// Factor of the flare, which is no sum.
    pub flare_scale: f32,
    /// Keeps the record at 16 bytes.
    pub padding: [f32; 2],
}

impl Exposure {
    /// Of the mean of `samples` samples.
    pub fn new(exposure: f32, samples: u32) -> Self {
        Self {
            scale: exposure / samples.max(1) as f32,
            flare_scale: exposure,
            padding: [0.0; 2],
        }
    }
}

/// The pipeline and the displayable image.
pub struct ToneMapPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    exposure: Uniform<Exposure>,
    image: BySize<Image>,
}

struct Image {
    target: Target,
    /// The same texels as codes, which is how a user interface takes them.
    codes: wgpu::TextureView,
    /// For either sum.
    inputs: [wgpu::BindGroup; 2],
}

impl ToneMapPass {
    /// Group 0: the sum, the exposure, the flare.
    pub const INPUT: [wgpu::BindingType; 3] = [texture(FLOAT), UNIFORM, texture(FLOAT)];
    /// Format of the image.
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
    /// The same, read without decoding.
    const CODES: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

    /// Compiles the pipeline.
    pub fn new(gpu: &Gpu) -> Self {
        let module = shader_module(gpu, &TONE_MAP);
        let layout = gpu.layout("tone map", &Self::INPUT);
        let targets = [color_target(Self::FORMAT)];
        Self {
            pipeline: gpu.pipeline(&PipelineParameters::fullscreen(
                "tone map",
                &module,
                &[&layout],
                &targets,
            )),
            layout,
            exposure: Uniform::new(gpu, "exposure"),
            image: BySize::default(),
        }
    }

    /// An image of `size` pixels out of two sums that take turns, and a flare.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2], sums: &[Target; 2], flare: &Target) {
        let (layout, exposure) = (&self.layout, &self.exposure);
        self.image.select(size, || {
            let input = |sum: &Target| {
                let resources = [sum.binding(), exposure.binding(), flare.binding()];
                gpu.group("tone map", layout, &resources)
            };
            let target = Target::with_views(gpu, "image", size, Self::FORMAT, &[Self::CODES]);
            let codes = target.texture.create_view(&wgpu::TextureViewDescriptor {
                format: Some(Self::CODES),
                usage: Some(wgpu::TextureUsages::TEXTURE_BINDING),
                ..Default::default()
            });
            Image {
                inputs: [input(&sums[0]), input(&sums[1])],
                target,
                codes,
            }
        });
    }

    /// The image, RGBA sRGB; none before the first size.
    pub fn image(&self) -> Option<&Target> {
        self.image.current().map(|image| &image.target)
    }

    /// The image's sRGB codes, undecoded; none before the first size.
    pub fn display_view(&self) -> Option<&wgpu::TextureView> {
        self.image.current().map(|image| &image.codes)
    }

    /// Draws the image of `samples` samples.
    pub fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        exposure: f32,
        samples: u32,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let Some(image) = self.image.current() else { return };
        self.exposure.write(gpu, &Exposure::new(exposure, samples));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tone map"),
            color_attachments: &[image.target.cleared(wgpu::Color::TRANSPARENT)],
            timestamp_writes: timestamps,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &image.inputs[(samples as usize + 1) % 2], &[]);
        pass.draw(0..3, 0..1);
    }
}
