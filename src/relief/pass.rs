//! The relief pass as a whole: ground, buildings one way or another, light.

use glam::DVec3;

use super::bindings::{UNIFORM, group_of, layout_of};
use super::exact::ExactPass;
use super::ground::GroundPass;
use super::polygons::PolygonsPass;
use super::shade::ShadePass;
use super::{BuildingMesh, FrameUniforms, Light, MapBindings};
use crate::gpu::{Gpu, GpuError, PassTimer, Target, color_target, uniform_buffer};
use crate::scene::{Frustum, Resident};
use crate::space::{Projection, View};

/// How buildings are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ReliefMode {
    /// Out of the building map, by an exact walk.
    Exact,
    /// As triangles of the digital map: ground truth and yardstick.
    Polygons,
}

/// No surface, as a clear value (`FAR` in `shaders/lib/frame.wgsl`).
pub const FAR: wgpu::Color = wgpu::Color {
    r: 3.0e38,
    g: 0.0,
    b: 0.0,
    a: 0.0,
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

/// Formats of the relief targets: distance, id, surface.
pub fn relief_target_states() -> [Option<wgpu::ColorTargetState>; 3] {
    [
        color_target(wgpu::TextureFormat::R32Float),
        color_target(wgpu::TextureFormat::R32Uint),
        color_target(wgpu::TextureFormat::Rg32Uint),
    ]
}

/// Images of one size that the pass draws.
pub struct ReliefTargets {
    /// Depth buffer, shared by the ground's and the buildings' pass.
    pub depth: Target,
    /// Ground: metres along the view ray.
    pub ground_distance: Target,
    /// Ground: packed normal.
    pub ground_normal: Target,
    /// Buildings: metres along the view ray.
    pub relief_distance: Target,
    /// Buildings: id.
    pub relief_id: Target,
    /// Buildings: facade coordinate and packed normal.
    pub relief_surface: Target,
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
            depth: target("depth", Format::Depth32Float),
            ground_distance: target("ground distance", Format::R32Float),
            ground_normal: target("ground normal", Format::R32Uint),
            relief_distance: target("relief distance", Format::R32Float),
            relief_id: target("relief id", Format::R32Uint),
            relief_surface: target("relief surface", Format::Rg32Uint),
            radiance: target("radiance", Format::Rgba16Float),
            distance: target("distance", Format::R32Float),
            id: target("id", Format::R32Uint),
        }
    }

    /// Begins the pass that draws buildings, with its targets cleared.
    pub fn begin_relief_pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'a> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("relief"),
            color_attachments: &[
                self.relief_distance.cleared(FAR),
                self.relief_id.cleared(wgpu::Color::TRANSPARENT),
                self.relief_surface.cleared(wgpu::Color::TRANSPARENT),
            ],
            depth_stencil_attachment: self.depth.cleared_depth(),
            timestamp_writes: timestamps,
            ..Default::default()
        })
    }
}

/// All pipelines for one resident city.
pub struct ReliefPass {
    frame_layout: wgpu::BindGroupLayout,
    map: MapBindings,
    ground: GroundPass,
    exact: ExactPass,
    shade: ShadePass,
    polygons: Option<PolygonsPass>,
}

impl ReliefPass {
    /// Compiles the pipelines.
    pub fn new(gpu: &Gpu, resident: &Resident) -> Self {
        let frame_layout = layout_of(gpu, "frame", &[UNIFORM]);
        let map = MapBindings::new(gpu, resident);
        Self {
            ground: GroundPass::new(gpu, resident, &frame_layout),
            exact: ExactPass::new(gpu, &frame_layout, &map),
            shade: ShadePass::new(gpu, &frame_layout, &map),
            polygons: None,
            frame_layout,
            map,
        }
    }

    /// Uploads the mesh that `ReliefMode::Polygons` draws.
    pub fn set_polygons(&mut self, gpu: &Gpu, mesh: &BuildingMesh, origin: DVec3) -> Result<(), GpuError> {
        self.polygons = Some(PolygonsPass::new(gpu, &self.frame_layout, mesh, origin)?);
        Ok(())
    }

    /// Number of timed passes: ground, buildings, light.
    pub const PASSES: u32 = 3;

    /// Encodes one sample of one view. Polygons without a mesh draw no buildings.
    #[allow(clippy::too_many_arguments)]
    pub fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        resident: &Resident,
        view: &View,
        projection: &Projection,
        light: &Light,
        sample: u32,
        mode: ReliefMode,
        targets: &ReliefTargets,
        timer: Option<&PassTimer>,
    ) {
        let uniforms = FrameUniforms::new(resident, view, projection, light, sample);
        let buffer = uniform_buffer(gpu, "frame", &uniforms);
        let frame = group_of(gpu, "frame", &self.frame_layout, vec![buffer.as_entire_binding()]);
        let frustum = Frustum::new(uniforms.clip_from_eye_relative, view.eye);
        let timed = |pass: u32| timer.and_then(|timer| timer.of_pass(pass));
        self.ground
            .encode(encoder, resident, view, &frustum, &frame, targets, timed(0));
        match (mode, &self.polygons) {
            (ReliefMode::Polygons, Some(polygons)) => {
                polygons.encode(gpu, encoder, view, &frame, targets, timed(1));
            }
            (ReliefMode::Polygons, None) => drop(targets.begin_relief_pass(encoder, timed(1))),
            (ReliefMode::Exact, _) => {
                self.exact.encode(
                    gpu,
                    encoder,
                    resident,
                    view,
                    &frustum,
                    &frame,
                    &self.map,
                    targets,
                    timed(1),
                );
            }
        }
        self.shade
            .encode(gpu, encoder, resident, &frame, &self.map, targets, timed(2));
    }
}
