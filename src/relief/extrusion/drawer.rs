//! Draws one textured rectangle with a displacement map.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, Mat4};

use super::overflow::faces_seen;
use crate::gpu::{
    Constant, ConstantValue, FILTERED, FLOAT, Gpu, GpuError, PipelineParameters, SAMPLER, ShaderSource,
    Target, UNIFORM, Uniform, color_target, filled_texture, read_texture, shader_file, shader_module,
    texture,
};
use crate::relief::{FAR, SearchParameters};
use crate::space::Projection;

/// The shader.
pub const SHADER: ShaderSource = ShaderSource {
    name: "relief/extrusion.wgsl",
    constants: &[FAR_CONSTANT],
    files: &[
        shader_file!("lib/search_parameters.wgsl"),
        shader_file!("lib/extrusion_search.wgsl"),
        shader_file!("relief/extrusion.wgsl"),
    ],
};
const FAR_CONSTANT: Constant = ("FAR", ConstantValue::Float(FAR));

/// How the map is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ExtrusionMethod {
    /// The texture alone.
    Flat,
    /// Sunk below the plane, as before the patent: the highest value lies on it.
    Sunken,
    /// Raised over the plane.
    Raised,
    /// Raised, with a tiled facade on steep slopes.
    Facades,
}

/// How what overflows is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Overflow {
    /// Not at all: it is cut at the rectangle.
    None,
    /// On the plane, extended.
    Extended,
    /// On the upright face of one border behind the rectangle; before a corner that of west or east.
    OneFace,
    /// On upright faces at all borders that it leaves by.
    Faces,
}

/// An image: 8-bit sRGB RGBA, rows from the north.
#[derive(Clone, Debug)]
pub struct TextureImage {
    /// Pixels.
    pub size: [u32; 2],
    /// One each.
    pub rgba: Vec<[u8; 4]>,
}

/// A displacement map, 0 to 1, rows from the north.
#[derive(Clone, Debug)]
pub struct HeightImage {
    /// Pixels.
    pub size: [u32; 2],
    /// One each.
    pub values: Vec<f32>,
}

/// A rectangle with its south-west corner at the origin, in the plane z = 0.
#[derive(Clone, Debug)]
pub struct Extrusion<'a> {
    /// Its texture.
    pub texture: &'a TextureImage,
    /// Its displacement map.
    pub height: &'a HeightImage,
    /// The tile on steep slopes.
    pub facade: &'a TextureImage,
    /// Size east and north, metres.
    pub size_m: DVec2,
    /// Height of the map's 1, metres.
    pub height_m: f64,
    /// Width of the facade's tile, metres.
    pub facade_m: f64,
    /// How the map is shown.
    pub method: ExtrusionMethod,
    /// How what overflows is shown.
    pub overflow: Overflow,
    /// How the search goes.
    pub search: SearchParameters,
}

/// Layout of `ExtrusionFrame` in `shaders/relief/extrusion.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct ExtrusionFrame {
    pub clip_from_eye_relative: Mat4,
    pub corner: [f32; 3],
    pub height_m: f32,
    pub size_m: [f32; 2],
    pub facade_m: [f32; 2],
    pub search: SearchParameters,
    pub method: u32,
    pub padding_a: u32,
    pub padding_b: u32,
    pub padding_c: u32,
}

/// Group 0: the scene, its texture and displacement map, the facade's tile and its sampler.
pub const INPUT: [wgpu::BindingType; 5] = [
    UNIFORM,
    texture(FLOAT),
    texture(FLOAT),
    texture(FILTERED),
    SAMPLER,
];

/// Behind all, linear.
const PAPER: wgpu::Color = wgpu::Color {
    r: 0.85,
    g: 0.84,
    b: 0.81,
    a: 1.0,
};

/// The image, 8-bit sRGB RGBA, rows from the top.
///
/// # Errors
/// When the device fails, or cannot hold the images.
pub fn draw_extrusion(
    gpu: &Gpu,
    extrusion: &Extrusion<'_>,
    projection: &Projection,
) -> Result<Vec<u8>, GpuError> {
    let limit = u64::from(gpu.device.limits().max_texture_dimension_2d);
    for size in [
        extrusion.texture.size,
        extrusion.height.size,
        extrusion.facade.size,
        projection.size,
    ] {
        gpu.require("an image", u64::from(size[0].max(size[1])), limit)?;
    }
    let layout = gpu.layout("extrusion", &INPUT);
    let module = shader_module(gpu, &SHADER);
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let pipeline = gpu.pipeline(&PipelineParameters {
        label: "extrusion",
        module: &module,
        layouts: &[&layout],
        vertex: "vs",
        buffers: &[],
        primitive: wgpu::PrimitiveState::default(),
        depth: None,
        targets: &[color_target(format)],
    });
    let frame = Uniform::new(gpu, "extrusion");
    frame.write(gpu, &frame_of(extrusion, projection));
    let image = |label, image: &TextureImage| filled_texture(gpu, label, image.size, format, &image.rgba);
    let (surface, facade) = (
        image("surface", extrusion.texture),
        image("facade", extrusion.facade),
    );
    let HeightImage { size, values } = extrusion.height;
    let height = filled_texture(gpu, "displacement", *size, wgpu::TextureFormat::R32Float, values);
    let sampler = gpu.tiling_sampler("facade");
    let view = wgpu::BindingResource::TextureView;
    let resources = [
        frame.binding(),
        view(&surface),
        view(&height),
        view(&facade),
        wgpu::BindingResource::Sampler(&sampler),
    ];
    let group = gpu.group("extrusion", &layout, &resources);
    let target = Target::new(gpu, "extrusion", projection.size, format);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("extrusion"),
            color_attachments: &[target.cleared(PAPER)],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        for piece in pieces(extrusion, projection.pose.eye) {
            pass.draw(0..6, piece..piece + 1);
        }
    }
    gpu.queue.submit([encoder.finish()]);
    let pixels = read_texture::<[u8; 4]>(gpu, &target.texture)?;
    Ok(pixels.into_flattened())
}

/// The rectangle, and the faces for what overflows: numbers as in the shader.
fn pieces(extrusion: &Extrusion<'_>, eye: DVec3) -> Vec<u32> {
    const RECTANGLE: u32 = 0;
    const EXTENSION: u32 = 1;
    const FACES: u32 = 2;
    let is_raised = matches!(
        extrusion.method,
        ExtrusionMethod::Raised | ExtrusionMethod::Facades
    );
    let seen = faces_seen(eye.truncate(), extrusion.size_m);
    let faces = (FACES..)
        .zip(seen)
        .filter(|(_, is_seen)| *is_seen)
        .map(|(face, _)| face);
    let overflow: Vec<u32> = match extrusion.overflow {
        _ if !is_raised => Vec::new(),
        Overflow::None => Vec::new(),
        Overflow::Extended => vec![EXTENSION],
        Overflow::OneFace => {
            // The one behind, where the eye is straight before a side: beside it none of the opposite one is seen.
            let behind = (0..4).find(|&face| seen[face] && !seen[face ^ 1]);
            behind.map(|face| FACES + face as u32).into_iter().collect()
        }
        Overflow::Faces => faces.collect(),
    };
    overflow.into_iter().chain([RECTANGLE]).collect()
}

fn frame_of(extrusion: &Extrusion<'_>, projection: &Projection) -> ExtrusionFrame {
    let [width, height] = extrusion.facade.size.map(f64::from);
    let aspect = height / width.max(1.0);
    ExtrusionFrame {
        clip_from_eye_relative: projection.clip_from_eye_relative(),
        corner: (-projection.pose.eye).as_vec3().to_array(),
        height_m: extrusion.height_m as f32,
        size_m: extrusion.size_m.as_vec2().to_array(),
        facade_m: [extrusion.facade_m as f32, (extrusion.facade_m * aspect) as f32],
        search: extrusion.search,
        method: extrusion.method as u32,
        padding_a: 0,
        padding_b: 0,
        padding_c: 0,
    }
}
