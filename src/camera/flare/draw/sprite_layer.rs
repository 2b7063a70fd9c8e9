//! Images that lie on the film: the sun with its starburst, and the recorded images of a table.

use bytemuck::{Pod, Zeroable};

use super::resources::Resources;
use crate::camera::shaders::SPRITE;
use crate::gpu::{Gpu, Uniform, filled_texture, shader_module};

/// Layout of `SpriteFrame` in `shaders/camera/sprite.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct SpriteFrame {
    pub centre_mm: [f32; 2],
    pub half_mm: [f32; 2],
    pub rotation: [f32; 2],
    pub image_half_mm: [f32; 2],
    pub radiance: [f32; 3],
    pub padding: f32,
}

/// The pipeline of sprites.
pub fn sprite_pipeline(gpu: &Gpu, resources: &Resources) -> wgpu::RenderPipeline {
    resources.sprite_pipeline(gpu, &shader_module(gpu, &SPRITE))
}

/// One image on the device.
pub struct Sprite {
    frame: Option<SpriteFrame>,
    uniform: Uniform<SpriteFrame>,
    group: wgpu::BindGroup,
    /// The image's brightest value. Half floats hold five digits: the texture goes up to 1, its scale into the frame's
    /// factor.
    peak: f32,
}

impl Sprite {
    /// Uploads linear RGB, rows from the top.
    pub fn new(gpu: &Gpu, resources: &Resources, size: [u32; 2], radiance: &[[f32; 3]]) -> Self {
        let peak = radiance
            .iter()
            .flatten()
            .fold(f32::MIN_POSITIVE, |peak, &value| peak.max(value));
        let texels: Vec<[half::f16; 4]> = radiance
            .iter()
            .map(|rgb| [rgb[0] / peak, rgb[1] / peak, rgb[2] / peak, 0.0].map(half::f16::from_f32))
            .collect();
        let image = filled_texture(gpu, "sprite", size, wgpu::TextureFormat::Rgba16Float, &texels);
        let uniform = Uniform::new(gpu, "sprite");
        Self {
            frame: None,
            group: resources.group(gpu, uniform.binding(), &image),
            uniform,
            peak,
        }
    }

    /// Says where it lies and what its values are multiplied by (`radiance`, f64 as the product may need it). True when that
    /// is new.
    pub fn set(&mut self, gpu: &Gpu, frame: SpriteFrame, radiance: [f64; 3]) -> bool {
        let frame = SpriteFrame {
            radiance: radiance.map(|channel| (channel * f64::from(self.peak)) as f32),
            ..frame
        };
        if self.frame == Some(frame) {
            return false;
        }
        self.uniform.write(gpu, &frame);
        self.frame = Some(frame);
        true
    }

    /// Draws it; the pipeline is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..4, 0..1);
    }
}
