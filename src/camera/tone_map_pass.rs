//! Exposes and tone-maps the mean of an image's samples and what the lens adds (`shaders/camera/tone_map.wgsl` tells how).

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use super::shaders::TONE_MAP;
use super::vignetting::{FALLOFF_PLACES, Vignetting};
use crate::gpu::{
    BySize, FLOAT, Gpu, PipelineParameters, Target, UNIFORM, Uniform, color_target, shader_module, texture,
};

/// Layout of `Exposure` in `shaders/camera/tone_map.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct Exposure {
    pub scale: f32,
    pub flare_scale: f32,
    pub centre: [f32; 2],
    pub white_balance: [f32; 3],
    pub places_per_pixel: f32,
    pub falloff: [glam::Vec4; 4],
}

/// What an image is developed with.
#[derive(Clone, Copy)]
pub struct ToneMapping<'a> {
    /// Factor on radiance.
    pub exposure: f32,
    /// Factors of the channels on top of that.
    pub white_balance: [f32; 3],
    /// Samples in the sum.
    pub samples: u32,
    /// The lens's vignetting, and millimetres of a pixel on the sensor; none without a lens.
    pub vignetting: Option<(&'a Vignetting, f64)>,
    /// Where the image's centre is, pixels from the first one drawn.
    pub centre: DVec2,
}

impl Exposure {
    /// As an image is developed.
    pub fn new(mapping: &ToneMapping<'_>) -> Self {
        let (falloff, places_per_pixel) = match mapping.vignetting {
            Some((vignetting, mm_per_pixel)) => {
                let places = (FALLOFF_PLACES - 1) as f64;
                (vignetting.falloff, places * mm_per_pixel / vignetting.corner_mm)
            }
            None => ([1.0; FALLOFF_PLACES], 0.0),
        };
        Self {
            scale: mapping.exposure / mapping.samples.max(1) as f32,
            flare_scale: mapping.exposure,
            centre: mapping.centre.as_vec2().to_array(),
            white_balance: mapping.white_balance,
            places_per_pixel: places_per_pixel as f32,
            falloff: std::array::from_fn(|k| glam::Vec4::from_slice(&falloff[4 * k..])),
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

    /// Forgets all images: the flares that they show are other ones.
    pub fn forget(&mut self) {
        self.image.clear();
    }

    /// The image, RGBA sRGB; none before the first size.
    pub fn image(&self) -> Option<&Target> {
        self.image.current().map(|image| &image.target)
    }

    /// The image's sRGB codes, undecoded; none before the first size.
    pub fn display_view(&self) -> Option<&wgpu::TextureView> {
        self.image.current().map(|image| &image.codes)
    }

    /// Draws the image.
    pub fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        mapping: &ToneMapping<'_>,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let Some(image) = self.image.current() else { return };
        self.exposure.write(gpu, &Exposure::new(mapping));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tone map"),
            color_attachments: &[image.target.cleared(wgpu::Color::TRANSPARENT)],
            timestamp_writes: timestamps,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &image.inputs[(mapping.samples as usize + 1) % 2], &[]);
        pass.draw(0..3, 0..1);
    }
}
