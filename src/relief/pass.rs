//! The relief pass as a whole: ground, buildings one way or another, light.

use glam::DVec3;

use super::ambient_pass::AmbientPass;
use super::cone_pass::ConePass;
use super::context::{PassContext, pass_number};
use super::exact_pass::ExactPass;
use super::ground_pass::GroundPass;
use super::light_pass::LightPass;
use super::polygons_pass::PolygonsPass;
use super::relief_view::ReliefView;
use super::search_pass::SearchPass;
use super::settings::ReliefMode;
use super::streets::StreetsRequest;
use super::targets::ReliefTargets;
use super::{BuildingMesh, CityBindings, FrameUniforms};
use crate::gpu::{BySize, Gpu, GpuError, PassTimer, UNIFORM, Uniform};
use crate::material::{MaterialTextures, OwnTiles, painted_tiles};
use crate::scene::{Frustum, Resident};
use crate::space::Sun;

/// All pipelines, uniforms and targets for one resident city.
pub struct ReliefPass {
    uniforms: Uniform<FrameUniforms>,
    frame_layout: wgpu::BindGroupLayout,
    frame: wgpu::BindGroup,
    city: CityBindings,
    ground: GroundPass,
    cone: ConePass,
    exact: ExactPass,
    ambient: AmbientPass,
    shade: LightPass,
    search: Option<SearchPass>,
    polygons: Option<PolygonsPass>,
    targets: BySize<ReliefTargets>,
}

impl ReliefPass {
    /// Group 0: the frame.
    pub const FRAME: [wgpu::BindingType; 1] = [UNIFORM];

    /// Compiles the pipelines; `own`: facades of the user's own; `streams`: frames do not wait for tiles.
    ///
    /// # Errors
    /// When the device cannot hold the materials.
    pub fn new(gpu: &Gpu, city: CityBindings, own: &[OwnTiles], streams: bool) -> Result<Self, GpuError> {
        let uniforms = Uniform::new(gpu, "frame");
        let frame_layout = gpu.layout("frame", &Self::FRAME);
        let layouts = [&frame_layout, &city.layout];
        // The materials are painted while the device compiles.
        let (tiles, (ground, cone, exact, ambient, light)) = rayon::join(
            || painted_tiles(own),
            || {
                (
                    GroundPass::new(gpu, layouts),
                    ConePass::new(gpu, layouts),
                    ExactPass::new(gpu, layouts),
                    AmbientPass::new(gpu, layouts),
                    LightPass::pipeline(gpu, layouts),
                )
            },
        );
        let materials = MaterialTextures::new(gpu, &tiles, own)?;
        Ok(Self {
            frame: gpu.group("frame", &frame_layout, &[uniforms.binding()]),
            uniforms,
            ground,
            cone,
            exact,
            ambient,
            shade: LightPass::new(gpu, light, materials, streams)?,
            search: None,
            polygons: None,
            targets: BySize::default(),
            frame_layout,
            city,
        })
    }

    /// Compiles what a mode needs beyond what all do, once.
    pub fn set_mode(&mut self, gpu: &Gpu, mode: ReliefMode) {
        if mode != ReliefMode::Search || self.search.is_some() {
            return;
        }
        let mut search = SearchPass::new(gpu, [&self.frame_layout, &self.city.layout]);
        if let Some(targets) = self.targets.current() {
            search.bind(gpu, targets);
        }
        self.search = Some(search);
    }

    /// Binds the resident city again, as parts of it were made anew.
    pub fn bind_city(&mut self, gpu: &Gpu, resident: &Resident) {
        self.city.bind(gpu, resident);
        self.shade.unbind();
        if let Some(targets) = self.targets.current() {
            self.shade.bind(gpu, targets, resident);
        }
    }

    /// Makes the sky of a sun, unless it is the last one.
    pub fn set_sun(&mut self, gpu: &Gpu, sun: &Sun) {
        self.shade.sky.set_sun(gpu, sun);
    }

    /// Makes the bounds of a view's sun, unless they are the last ones.
    pub fn set_sun_bounds(&mut self, gpu: &Gpu, resident: &Resident, sun: &Sun, eye: DVec3) {
        self.shade.sun_bounds.prepare(gpu, resident, sun, eye.truncate());
    }

    /// Makes the streets for a frame, unless they are the last ones.
    pub fn set_streets(&mut self, gpu: &Gpu, resident: &Resident, request: StreetsRequest<'_>) {
        self.shade.streets.prepare(gpu, resident, request);
    }

    /// A number that changes when other streets are shown, and whether some are still to come.
    pub fn streets_state(&self) -> (u64, bool) {
        (self.shade.streets.version(), self.shade.streets.is_pending())
    }

    /// Irradiance of level ground by the open sky for the last sun set, linear sRGB.
    pub fn sky_on_level_ground(&self) -> DVec3 {
        self.shade.sky.on_level_ground()
    }

    /// Uploads the mesh that [`ReliefMode::Polygons`] draws.
    ///
    /// # Errors
    /// When the device cannot hold it.
    pub fn set_polygons(&mut self, gpu: &Gpu, mesh: &BuildingMesh, origin: DVec3) -> Result<(), GpuError> {
        let mut polygons = PolygonsPass::new(gpu, &self.frame_layout, mesh, origin)?;
        if let Some(targets) = self.targets.current() {
            polygons.bind(gpu, targets);
        }
        self.polygons = Some(polygons);
        Ok(())
    }

    /// Puts the targets of `size` pixels in use.
    pub fn resize(&mut self, gpu: &Gpu, resident: &Resident, size: [u32; 2]) -> &ReliefTargets {
        let targets = self.targets.select(size, || ReliefTargets::new(gpu, size));
        self.exact.bind(gpu, targets);
        self.ambient.bind(gpu, targets);
        self.shade.bind(gpu, targets, resident);
        if let Some(search) = &mut self.search {
            search.bind(gpu, targets);
        }
        if let Some(polygons) = &mut self.polygons {
            polygons.bind(gpu, targets);
        }
        targets
    }

    /// The images of the last size asked for.
    pub fn targets(&self) -> Option<&ReliefTargets> {
        self.targets.current()
    }

    /// Encodes one sample of one view into the targets, in a mode that was set. Polygons without a mesh draw no buildings.
    pub fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        resident: &Resident,
        view: &ReliefView<'_>,
        timer: &PassTimer,
    ) {
        let Some(targets) = self.targets.current() else {
            return;
        };
        let ReliefView {
            projection,
            settings,
            band,
            ..
        } = *view;
        self.uniforms
            .write(gpu, &FrameUniforms::new(resident, view, &self.shade));
        let mut context = PassContext {
            gpu,
            encoder,
            resident,
            projection,
            frustum: Frustum::new(projection),
            frame: &self.frame,
            city: &self.city.group,
            targets,
            band,
            timer,
        };
        if band.is_first() {
            self.ground.encode(&mut context);
        }
        match (settings.mode, &self.polygons) {
            (ReliefMode::Polygons, _) if !band.is_first() => {}
            (ReliefMode::Polygons, Some(polygons)) if settings.layers.buildings => {
                polygons.encode(&mut context)
            }
            (ReliefMode::Polygons, _) => {
                let timestamps = timer.pass(pass_number::BUILDINGS);
                drop(targets.begin_buildings_pass(context.encoder, band, timestamps));
            }
            (ReliefMode::Search, _) => {
                if let Some(search) = &self.search {
                    search.encode(&mut context);
                }
            }
            (ReliefMode::Exact, _) => {
                if band.is_first() {
                    self.cone.encode(&mut context);
                }
                self.exact.encode(&mut context);
            }
        }
        self.ambient.encode(&mut context);
        self.shade.encode(&mut context);
    }
}
