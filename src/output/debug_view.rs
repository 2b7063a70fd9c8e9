//! A debug view of any intermediate image of a frame, by name (`shaders/output/debug_view.wgsl` tells how each is coloured).

use bytemuck::{Pod, Zeroable};
use wgpu::TextureSampleType::Uint;

use super::{RenderError, Renderer};
use crate::gpu::{
    Constant, FLOAT, Gpu, PipelineParameters, ShaderSource, Target, UNIFORM, Uniform, color_target,
    read_texture, shader_file, shader_module, texture,
};

/// The shader.
pub const DEBUG_VIEW: ShaderSource = ShaderSource {
    name: "output/debug_view.wgsl",
    constants: CONSTANTS,
    files: &[
        shader_file!("fullscreen.wgsl"),
        shader_file!("output/debug_view.wgsl"),
    ],
};

const CONSTANTS: &[Constant] = &[("FAR", crate::gpu::ConstantValue::Float(crate::relief::FAR))];

/// An intermediate image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Intermediate {
    /// Distance of the ground along the view ray.
    GroundDistance,
    /// Normal of the ground.
    GroundNormal,
    /// Distance that blocks of pixels skip before the walk.
    ConeDistance,
    /// Distance of the buildings.
    BuildingDistance,
    /// Normal of the buildings.
    BuildingNormal,
    /// Metres along the outline of walls.
    FacadeCoordinate,
    /// Distance of what is seen.
    Distance,
    /// Id of what is seen.
    Id,
    /// Radiance of the last sample.
    Radiance,
    /// What the lens adds.
    Flare,
}

/// How the shader reads and colours an image.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct DebugFrame {
    /// Which way of colouring.
    pub kind: u32,
    /// Which component of an integer image.
    pub component: u32,
    /// Pixels of the image, by those of the view.
    pub scale: [f32; 2],
}

/// The pipeline.
pub struct DebugView {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    frame: Uniform<DebugFrame>,
    /// What is bound in the place of the image of the other type.
    no_float: Target,
    no_uint: Target,
}

const DISTANCE: u32 = 0;
const DISTANCE_BITS: u32 = 1;
const NORMAL: u32 = 2;
const ID: u32 = 3;
const METRES_BITS: u32 = 4;
const RADIANCE: u32 = 5;

impl DebugView {
    /// Group 0: how, an image of floats, an image of integers.
    pub const INPUT: [wgpu::BindingType; 3] = [UNIFORM, texture(FLOAT), texture(Uint)];
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

    /// Compiles the pipeline.
    pub fn new(gpu: &Gpu) -> Self {
        let module = shader_module(gpu, &DEBUG_VIEW);
        let layout = gpu.layout("debug view", &Self::INPUT);
        let targets = [color_target(Self::FORMAT)];
        let none = |format| Target::new(gpu, "none", [1; 2], format);
        Self {
            pipeline: gpu.pipeline(&PipelineParameters::fullscreen(
                "debug view",
                &module,
                &[&layout],
                &targets,
            )),
            layout,
            frame: Uniform::new(gpu, "debug view"),
            no_float: none(wgpu::TextureFormat::R32Float),
            no_uint: none(wgpu::TextureFormat::R32Uint),
        }
    }
}

impl Renderer {
    /// An intermediate image of the last frame in false colours: 8-bit sRGB, rows from the top. Makes its own target and group, so
    /// that a frame need not.
    ///
    /// # Errors
    /// When the device fails.
    pub fn debug_image(&self, which: Intermediate) -> Result<Vec<u8>, RenderError> {
        let (Some(targets), Some(flare)) = (self.relief_targets(), self.flare.target()) else {
            return Ok(Vec::new());
        };
        let (source, kind, component) = match which {
            Intermediate::GroundDistance => (&targets.ground_distance, DISTANCE, 0),
            Intermediate::GroundNormal => (&targets.ground_normal, NORMAL, 0),
            Intermediate::ConeDistance => (&targets.cone_distance, DISTANCE, 0),
            Intermediate::BuildingDistance => (&targets.building_surface, DISTANCE_BITS, 0),
            Intermediate::BuildingNormal => (&targets.building_surface, NORMAL, 3),
            Intermediate::FacadeCoordinate => (&targets.building_surface, METRES_BITS, 2),
            Intermediate::Distance => (&targets.distance, DISTANCE, 0),
            Intermediate::Id => (&targets.id, ID, 0),
            Intermediate::Radiance => (&targets.radiance, RADIANCE, 0),
            Intermediate::Flare => (flare, RADIANCE, 0),
        };
        let gpu = &self.gpu;
        let view = &self.debug_view;
        let size = self.size();
        let source_size = source.texture.size();
        view.frame.write(
            gpu,
            &DebugFrame {
                kind,
                component,
                scale: [
                    source_size.width as f32 / size[0] as f32,
                    source_size.height as f32 / size[1] as f32,
                ],
            },
        );
        let is_float = matches!(kind, DISTANCE | RADIANCE);
        let [float, uint] = if is_float {
            [source, &view.no_uint]
        } else {
            [&view.no_float, source]
        };
        let resources = [view.frame.binding(), float.binding(), uint.binding()];
        let group = gpu.group("debug view", &view.layout, &resources);
        let target = Target::new(gpu, "debug view", size, DebugView::FORMAT);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("debug view"),
                color_attachments: &[target.cleared(wgpu::Color::BLACK)],
                ..Default::default()
            });
            pass.set_pipeline(&view.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        gpu.queue.submit([encoder.finish()]);
        Ok(read_texture(gpu, &target.texture)?)
    }
}
