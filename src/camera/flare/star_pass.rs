//! Adds the sun's starburst to a picture.

use bytemuck::{Pod, Zeroable};
use wgpu::util::{DeviceExt, TextureDataOrder};

use super::{Aperture, Diffraction, Wavelength};
use crate::camera::shaders::STARBURST;
use crate::gpu::{Gpu, Target, shader_module, uniform_buffer};

/// Layout of `StarFrame` in `shaders/camera/starburst.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct StarFrame {
    middle: [f32; 2],
    half: [f32; 2],
    radiance: [f32; 3],
    padding: f32,
}

/// Side of the aperture's mask for the transform, texels; and how many pupil diameters it spans: two, so that the power,
/// whose frequencies are twice the amplitude's, is sampled finely enough.
const MASK_SIDE: usize = 4096;
const MASK_REACH: f64 = 2.0;
/// Side of the pattern, texels.
const PATTERN_SIDE: u32 = 1024;

/// A source's sharp image and where it stands.
#[derive(Clone, Copy, Debug)]
pub struct Star {
    /// On the sensor, millimetres, x right and y up.
    pub at_mm: [f64; 2],
    /// Radius of its sharp image, millimetres.
    pub disc_mm: f64,
    /// Focal length, millimetres.
    pub focal_mm: f64,
    /// f-number.
    pub f_number: f64,
    /// Irradiance on a surface facing it, linear sRGB, already times its visible share.
    pub irradiance: [f64; 3],
}

/// Adds the image of a disc with its diffraction to `target`, whose picture spans `half_mm` to each side. The whole light of
/// the source falls on the sensor as irradiance times f² per solid angle: radiance = irradiance · f² · spread.
pub fn encode_starburst(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    target: &Target,
    star: &Star,
    aperture: &Aperture,
    colours: &[Wavelength],
    half_mm: [f64; 2],
) {
    let diffraction = Diffraction::of(aperture, MASK_SIDE, MASK_REACH);
    let span_mm = 0.5 * MASK_SIDE as f64 * diffraction.bin_mm(0.5, star.f_number);
    let spread = diffraction.spread(
        colours,
        star.f_number,
        star.disc_mm,
        PATTERN_SIDE as usize,
        span_mm,
    );
    let most = spread
        .iter()
        .flatten()
        .fold(f32::MIN_POSITIVE, |most, &value| most.max(value));
    // Half floats hold five digits: the pattern goes up to 1, its scale into the uniform.
    let texels: Vec<[half::f16; 4]> = spread
        .iter()
        .map(|rgb| [rgb[0] / most, rgb[1] / most, rgb[2] / most, 0.0].map(half::f16::from_f32))
        .collect();
    let texture = gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some("starburst"),
            size: wgpu::Extent3d {
                width: PATTERN_SIDE,
                height: PATTERN_SIDE,
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
    let scale = star.focal_mm * star.focal_mm * f64::from(most);
    let frame = StarFrame {
        middle: [0, 1].map(|axis| (star.at_mm[axis] / half_mm[axis]) as f32),
        half: half_mm.map(|side| (span_mm / side) as f32),
        radiance: star.irradiance.map(|channel| (channel * scale) as f32),
        padding: 0.0,
    };
    let uniforms = uniform_buffer(gpu, "starburst", &frame);
    let module = shader_module(gpu, &STARBURST);
    let pipeline = super::added_pipeline(
        gpu,
        &module,
        target.texture.format(),
        &[],
        wgpu::PrimitiveTopology::TriangleStrip,
    );
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let group = super::picture_group(gpu, &pipeline, &uniforms, &view, &sampler);
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("starburst"),
        color_attachments: &[target.kept()],
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.draw(0..4, 0..1);
}
