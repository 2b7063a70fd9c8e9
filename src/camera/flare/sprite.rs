//! Adds an image that lies on the film to a picture.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;
use wgpu::util::{DeviceExt, TextureDataOrder};

use super::{ImageTable, Laid, added_pipeline, picture_group};
use crate::camera::shaders::SPRITE;
use crate::gpu::{Gpu, Target, shader_module, uniform_buffer};

/// Layout of `SpriteFrame` in `shaders/camera/sprite.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct SpriteFrame {
    pub centre_mm: [f32; 2],
    pub half_mm: [f32; 2],
    pub turn: [f32; 2],
    pub image_half_mm: [f32; 2],
    pub radiance: [f32; 3],
    pub padding: f32,
}

/// An image and its place.
pub struct Sprite<'a> {
    /// Linear RGB up to 1, rows from the top.
    pub texels: &'a [[f32; 3]],
    /// Columns and rows.
    pub size: [u32; 2],
    /// Its centre on the film before the turn, millimetres, x right and y up.
    pub centre_mm: DVec2,
    /// Half its sides.
    pub half_mm: DVec2,
    /// Turn about the centre of the film, anticlockwise, radians.
    pub turn: f64,
    /// Factor on its values.
    pub radiance: [f64; 3],
}

/// Adds a sprite to `target`, whose picture spans `image_half_mm` to each side.
pub fn encode_sprite(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    target: &Target,
    sprite: &Sprite<'_>,
    image_half_mm: [f64; 2],
) {
    let texels: Vec<[half::f16; 4]> = sprite
        .texels
        .iter()
        .map(|rgb| [rgb[0], rgb[1], rgb[2], 0.0].map(half::f16::from_f32))
        .collect();
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some("sprite"),
            size: wgpu::Extent3d {
                width: sprite.size[0],
                height: sprite.size[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(&texels),
    );
    let frame = SpriteFrame {
        centre_mm: sprite.centre_mm.as_vec2().to_array(),
        half_mm: sprite.half_mm.as_vec2().to_array(),
        turn: DVec2::from_angle(sprite.turn).as_vec2().to_array(),
        image_half_mm: image_half_mm.map(|side| side as f32),
        radiance: sprite.radiance.map(|channel| channel as f32),
        padding: 0.0,
    };
    let uniforms = uniform_buffer(gpu, "sprite", &frame);
    let module = shader_module(gpu, &SPRITE);
    let pipeline = added_pipeline(
        gpu,
        &module,
        target.texture.format(),
        &[],
        wgpu::PrimitiveTopology::TriangleStrip,
        Laid::Added,
    );
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let group = picture_group(gpu, &pipeline, &uniforms, &view, &sampler);
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("sprite"),
        color_attachments: &[target.loaded()],
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.draw(0..4, 0..1);
}

/// Adds the images of a table for a light of an irradiance (linear sRGB) at an angle and turn, radians.
pub fn encode_images(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    target: &Target,
    table: &ImageTable,
    [angle, turn]: [f64; 2],
    irradiance: [f64; 3],
    image_half_mm: [f64; 2],
) {
    for evaluated in table.evaluate(angle, turn) {
        let image = evaluated.image;
        let (low, high) = (DVec2::from_array(image.low_mm), DVec2::from_array(image.high_mm));
        let radiance = image.radiance();
        let most = radiance
            .iter()
            .flatten()
            .fold(f32::MIN_POSITIVE, |most, &value| most.max(value));
        // Half floats hold five digits: the texture goes up to 1.
        let texels: Vec<[f32; 3]> = radiance.iter().map(|rgb| rgb.map(|value| value / most)).collect();
        let sprite = Sprite {
            texels: &texels,
            size: image.size,
            centre_mm: 0.5 * (low + high),
            half_mm: 0.5 * (high - low),
            turn: evaluated.turn,
            radiance: irradiance.map(|channel| channel * evaluated.share * f64::from(most)),
        };
        encode_sprite(gpu, encoder, target, &sprite, image_half_mm);
    }
}
