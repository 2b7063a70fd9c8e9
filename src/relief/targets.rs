//! The images that the relief pass draws, and how its pipelines draw into them.

use super::constants::{CONE_PIXELS, FAR};
use crate::gpu::{Band, Gpu, Target, color_target};

/// No surface, as a clear value.
pub const FAR_COLOR: wgpu::Color = wgpu::Color {
    r: FAR as f64,
    g: 0.0,
    b: 0.0,
    a: 0.0,
};

/// No building, as a clear value.
const NO_BUILDING: wgpu::Color = wgpu::Color {
    r: FAR.to_bits() as f64,
    ..wgpu::Color::TRANSPARENT
};

/// Depth test of reversed depth: larger is nearer.
pub fn reversed_depth() -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: wgpu::TextureFormat::Depth32Float,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// Formats of the buildings' targets.
pub fn relief_target_states() -> [Option<wgpu::ColorTargetState>; 2] {
    [wgpu::TextureFormat::Rgba32Uint; 2].map(color_target)
}

/// Images of one size that the pass draws.
pub struct ReliefTargets {
    /// Pixels.
    pub size: [u32; 2],
    /// Depth buffer, shared by the ground's and the buildings' pass.
    pub depth: Target,
    /// Ground: metres along the view ray.
    pub ground_distance: Target,
    /// Ground: packed normal.
    pub ground_normal: Target,
    /// Per block of pixels: metres along its view rays without a building.
    pub cone_distance: Target,
    /// Buildings: bits of the metres along the view ray, id, bits of the facade coordinate (bays) or a roof's place in the map, packed normal.
    pub building_surface: Target,
    /// Buildings: bits of the bays a metre, the base and the height, what they are made of (`shaders/lib/building_texels.wgsl`).
    pub building_facade: Target,
    /// At half the size: where the rays of light from all round end (`shaders/relief/ambient.wgsl`).
    pub ambient_rays: Target,
    /// Linear radiance.
    pub radiance: Target,
    /// Metres along the view ray of what is seen, 3e38 for sky.
    pub distance: Target,
    /// Id of what is seen, 0 for ground and sky.
    pub id: Target,
}

impl ReliefTargets {
    /// Targets of `size` pixels.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        use wgpu::TextureFormat as Format;
        let target = |label: &str, format| Target::new(gpu, label, size, format);
        Self {
            size,
            depth: target("depth", Format::Depth32Float),
            ground_distance: target("ground distance", Format::R32Float),
            ground_normal: target("ground normal", Format::R32Uint),
            cone_distance: Target::new(
                gpu,
                "cone distance",
                size.map(|side| side.div_ceil(CONE_PIXELS)),
                Format::R32Float,
            ),
            building_surface: target("building surface", Format::Rgba32Uint),
            building_facade: target("building facade", Format::Rgba32Uint),
            ambient_rays: Target::new(
                gpu,
                "ambient rays",
                size.map(|side| side.div_ceil(2)),
                Format::Rg32Uint,
            ),
            radiance: target("radiance", Format::Rgba16Float),
            distance: target("distance", Format::R32Float),
            id: target("id", Format::R32Uint),
        }
    }

    /// Begins the pass that draws a band of the buildings, with its targets cleared.
    pub fn begin_buildings_pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        band: Band,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'a> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("buildings"),
            color_attachments: &[
                band.attachment(&self.building_surface, NO_BUILDING),
                band.attachment(&self.building_facade, wgpu::Color::TRANSPARENT),
            ],
            depth_stencil_attachment: self.depth.cleared_depth(),
            timestamp_writes: timestamps,
            ..Default::default()
        })
    }
}
