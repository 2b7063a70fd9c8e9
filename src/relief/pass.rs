//! The relief pass as a whole: ground, buildings one way or another, light.

use glam::DVec3;

use super::bindings::{UNIFORM, group_of, layout_of};
use super::cone::ConePass;
use super::exact::ExactPass;
use super::ground::GroundPass;
use super::polygons::PolygonsPass;
use super::shade::ShadePass;
use super::targets::ReliefTargets;
use super::{BuildingMesh, FrameUniforms, Light, MapBindings};
use crate::gpu::{Gpu, GpuError, PassTimer, uniform_buffer};
use crate::scene::{Frustum, Resident};
use crate::space::{Projection, View};

/// How buildings are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ReliefMode {
    /// Out of the building map, by an exact walk.
    Exact,
    /// As triangles of the footprint dataset: ground truth and yardstick.
    Polygons,
}

/// All pipelines for one resident city.
pub struct ReliefPass {
    frame_layout: wgpu::BindGroupLayout,
    map: MapBindings,
    ground: GroundPass,
    cone: ConePass,
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
            cone: ConePass::new(gpu, &frame_layout, &map),
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
                polygons.encode(gpu, encoder, view, &frustum, &frame, targets, timed(1));
            }
            (ReliefMode::Polygons, None) => drop(targets.begin_relief_pass(encoder, timed(1))),
            (ReliefMode::Exact, _) => {
                let begin = timer.and_then(|timer| timer.begin_of_pass(1));
                let end = timer.and_then(|timer| timer.end_of_pass(1));
                self.cone.encode(encoder, &frame, &self.map, targets, begin);
                self.exact.encode(gpu, encoder, &frame, &self.map, targets, end);
            }
        }
        self.shade.encode(
            gpu,
            encoder,
            resident,
            &frame,
            &self.map,
            sample,
            targets,
            timed(2),
        );
    }
}
