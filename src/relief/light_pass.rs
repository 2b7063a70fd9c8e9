//! Lights the surfaces that the ground and relief passes found.

use wgpu::TextureSampleType::Uint;

use super::context::{PassContext, pass_number};
use super::shaders::LIGHT;
use super::sky_tables::SkyTables;
use super::streets::StreetsTexture;
use super::sun_bounds_texture::SunBoundsTexture;
use super::targets::{FAR_COLOR, ReliefTargets};
use crate::gpu::{
    BySize, FILTERED, FLOAT, Gpu, GpuError, PipelineParameters, SAMPLER, color_target, shader_module,
    texture, texture_array,
};
use crate::material::MaterialTextures;
use crate::scene::Resident;

/// The pipeline.
pub struct LightPass {
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    tiling_sampler: wgpu::Sampler,
    materials: MaterialTextures,
    /// The sky.
    pub sky: SkyTables,
    /// Where the sun is seen for sure.
    pub sun_bounds: SunBoundsTexture,
    /// Where streets run, for bare ground.
    pub streets: StreetsTexture,
    input_layout: wgpu::BindGroupLayout,
    input: BySize<wgpu::BindGroup>,
}

/// The pipeline and the layout of its input, which may be made before there are materials.
pub type LightPipeline = (wgpu::RenderPipeline, wgpu::BindGroupLayout);

impl LightPass {
    /// Group 2: the ground's distance and normal, the buildings' surface and facade, imagery and its sampler; colours and details of
    /// the materials, their sampler, the palette; the sky; the ambient pass's rays; the sun bounds; the site coverage;
    /// the streets.
    pub const INPUT: [wgpu::BindingType; 15] = [
        texture(FLOAT),
        texture(Uint),
        texture(Uint),
        texture(Uint),
        texture_array(FILTERED),
        SAMPLER,
        texture_array(FILTERED),
        texture_array(FILTERED),
        SAMPLER,
        texture(FLOAT),
        texture_array(FILTERED),
        texture(Uint),
        texture_array(FLOAT),
        texture_array(FILTERED),
        texture_array(FILTERED),
    ];

    /// Compiles the pipeline for the layouts of groups 0 and 1.
    pub fn pipeline(gpu: &Gpu, [frame, city]: [&wgpu::BindGroupLayout; 2]) -> LightPipeline {
        let module = shader_module(gpu, &LIGHT);
        let input_layout = gpu.layout("shade input", &Self::INPUT);
        let targets = [
            color_target(wgpu::TextureFormat::Rgba16Float),
            color_target(wgpu::TextureFormat::R32Float),
            color_target(wgpu::TextureFormat::R32Uint),
        ];
        let layouts = [frame, city, &input_layout];
        let parameters = PipelineParameters::fullscreen("shade", &module, &layouts, &targets);
        (gpu.pipeline(&parameters), input_layout)
    }

    /// `streams`: frames do not wait for tiles.
    ///
    /// # Errors
    /// When the device cannot hold its tables.
    pub fn new(
        gpu: &Gpu,
        (pipeline, input_layout): LightPipeline,
        materials: MaterialTextures,
        streams: bool,
    ) -> Result<Self, GpuError> {
        Ok(Self {
            pipeline,
            sampler: gpu.linear_sampler("imagery", true),
            tiling_sampler: gpu.tiling_sampler("materials"),
            materials,
            sky: SkyTables::new(gpu)?,
            sun_bounds: SunBoundsTexture::new(gpu)?,
            streets: StreetsTexture::new(gpu, streams)?,
            input_layout,
            input: BySize::default(),
        })
    }

    /// Binds the targets of a new size.
    pub fn bind(&mut self, gpu: &Gpu, targets: &ReliefTargets, resident: &Resident) {
        let view = wgpu::BindingResource::TextureView;
        let resources = [
            targets.ground_distance.binding(),
            targets.ground_normal.binding(),
            targets.building_surface.binding(),
            targets.building_facade.binding(),
            view(&resident.imagery.layers.view),
            wgpu::BindingResource::Sampler(&self.sampler),
            view(&self.materials.colour.view),
            view(&self.materials.detail.view),
            wgpu::BindingResource::Sampler(&self.tiling_sampler),
            view(&self.materials.palette),
            view(&self.sky.images.view),
            targets.ambient_rays.binding(),
            view(&self.sun_bounds.images.view),
            view(&resident.coverage.image.view),
            view(&self.streets.images.view),
        ];
        let layout = &self.input_layout;
        self.input
            .select(targets.size, || gpu.group("shade input", layout, &resources));
    }

    /// Forgets what is bound to imagery that was made anew.
    pub fn unbind(&mut self) {
        self.input.clear();
    }

    /// Encodes the pass: the end of the light's time.
    pub fn encode(&self, context: &mut PassContext<'_>) {
        let (targets, band) = (context.targets, context.band);
        let mut pass = context.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("light"),
            color_attachments: &[
                band.attachment(&targets.radiance, wgpu::Color::BLACK),
                band.attachment(&targets.distance, FAR_COLOR),
                band.attachment(&targets.id, wgpu::Color::TRANSPARENT),
            ],
            timestamp_writes: context.timer.pass_end(pass_number::LIGHT),
            ..Default::default()
        });
        if !band.confine(&mut pass, targets.size) {
            return;
        }
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, context.frame, &[]);
        pass.set_bind_group(1, context.city, &[]);
        pass.set_bind_group(2, self.input.current(), &[]);
        pass.draw(0..3, 0..1);
    }
}
