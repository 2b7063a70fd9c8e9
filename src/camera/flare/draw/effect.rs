//! The flare as a persistent pass.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;

use super::ghost_layer::GhostLayer;
use super::request::FlareRequest;
use super::resources::Resources;
use super::sprite_layer::{Sprite, SpriteFrame, sprite_pipeline};
use crate::camera::flare::{
    Aperture, FlareMesh, FlareSource, GhostParameters, GhostTable, StarburstOptics, StarburstParameters,
    StarburstPattern, Tracing, TracingDevice, flare_mesh,
};
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::{Paraxial, RayPass};
use crate::gpu::{Gpu, GpuError, PassTimer, Target};

/// The sun's ghosts and starburst of one lens, ready to be added to an image; nothing is made anew while its inputs stay.
///
/// | what is kept | until one of these changes |
/// |---|---|
/// | the aperture's mask | aperture |
/// | the ghosts' mesh | lens, f-number, ghost parameters, table, direction of the light |
/// | a table's images on the device | table, knots beside the direction of the light |
/// | the starburst's pattern | aperture, f-number, lens, starburst parameters, radius of the light |
///
/// All else (irradiance, visible fraction, size of the image, where the starburst lies) is a uniform.
pub struct FlareEffect {
    resources: Resources,
    sprites: wgpu::RenderPipeline,
    rays: RayPass,
    aperture: Option<Aperture>,
    ghosts: GhostLayer,
    mesh: Option<MeshKey>,
    statistics: MeshStatistics,
    images: Vec<(ImageKey, Sprite)>,
    starburst: Option<Starburst>,
    is_lit: bool,
    fills: CacheFills,
}

/// How often each cache has been filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CacheFills {
    /// Masks of apertures.
    pub masks: u32,
    /// Meshes of ghosts.
    pub meshes: u32,
    /// Images of tables.
    pub images: u32,
    /// Patterns of starbursts.
    pub starbursts: u32,
}

/// What is known of the mesh that is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshStatistics {
    /// Triangles.
    pub triangles: usize,
    /// Area of all triangles in the film's plane, square millimetres: the raster work, the film's edge apart.
    pub area_mm2: f64,
    /// Milliseconds to make it, tracing included.
    pub make_ms: f64,
}

/// A shared value that is told from others by its address.
#[derive(Clone)]
struct Identity<T>(Arc<T>);

impl<T> PartialEq for Identity<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[derive(Clone, PartialEq)]
struct MeshKey {
    lens: Identity<Lens>,
    table: Option<Identity<GhostTable>>,
    source: FlareSource,
    ghosts: GhostParameters,
}

#[derive(Clone, PartialEq)]
struct ImageKey {
    table: Identity<GhostTable>,
    is_photo: bool,
    index: usize,
}

struct Starburst {
    optics: StarburstOptics,
    parameters: StarburstParameters,
    disc_fraction: [f64; 3],
    /// Of a disc as large as the light's visible part, by the light's: a smaller one spreads more of its light.
    visible_radius: f64,
    /// Half the side of each, with what it shows: pattern, far spikes and veil.
    sprites: [(f64, Sprite); 3],
}

impl FlareEffect {
    /// Makes pipelines, for targets of a format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let resources = Resources::new(gpu, format);
        Self {
            sprites: sprite_pipeline(gpu, &resources),
            ghosts: GhostLayer::new(gpu, &resources),
            resources,
            rays: RayPass::new(gpu),
            aperture: None,
            mesh: None,
            statistics: MeshStatistics::default(),
            images: Vec::new(),
            starburst: None,
            is_lit: false,
            fills: CacheFills::default(),
        }
    }

    /// Brings meshes, textures and uniforms up to date. Makes resources on the device only where a cache's inputs changed.
    /// For an image of `size` pixels. True when the flare looks otherwise than before.
    ///
    /// # Errors
    /// When the device fails while it traces rays.
    pub fn prepare(&mut self, gpu: &Gpu, request: &FlareRequest, size: [u32; 2]) -> Result<bool, GpuError> {
        let is_lit = request.light.is_lit();
        let mut changed = self.is_lit != is_lit;
        self.is_lit = is_lit;
        if is_lit {
            changed |= self.prepare_mask(gpu, &request.aperture);
            changed |= self.prepare_mesh(gpu, request)?;
            changed |= self.prepare_images(gpu, request);
            changed |= self.prepare_starburst(gpu, request);
            let irradiance = request.light.visible_irradiance();
            let image = (size, request.image_half_mm);
            changed |= self.ghosts.set_frame(gpu, &self.resources, image, irradiance);
        }
        Ok(changed)
    }

    /// Adds the prepared flare to what `target` holds. `timed` is a timer and the number of the pass that all this is.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &Target,
        timed: Option<(&PassTimer, u32)>,
    ) {
        let begin = timed.and_then(|(timer, pass)| timer.pass_begin(pass));
        let is_begun = begin.is_none();
        let begin = if self.is_lit {
            self.ghosts.encode_soft(encoder, target, begin)
        } else {
            begin
        };
        let end = timed.and_then(|(timer, pass)| {
            if begin.is_some() || is_begun {
                timer.pass(pass)
            } else {
                timer.pass_end(pass)
            }
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("flare"),
            color_attachments: &[target.loaded()],
            timestamp_writes: end,
            ..Default::default()
        });
        if !self.is_lit {
            return;
        }
        self.ghosts.draw_sharp(&mut pass, target);
        pass.set_pipeline(&self.sprites);
        let images = self.images.iter().map(|(_, sprite)| sprite);
        let starburst = self.starburst.iter().flat_map(|starburst| &starburst.sprites);
        for sprite in images.chain(starburst.map(|(_, sprite)| sprite)) {
            sprite.draw(&mut pass);
        }
    }

    /// Part of the light, by channel, that its sharp image keeps and the starburst does not draw; all of it without a starburst.
    pub fn disc_fraction(&self) -> [f64; 3] {
        match &self.starburst {
            Some(starburst) if self.is_lit => {
                let spread = |kept: f64| (1.0 - kept) / starburst.visible_radius;
                starburst.disc_fraction.map(|kept| (1.0 - spread(kept)).max(0.0))
            }
            _ => [1.0; 3],
        }
    }

    /// How often each cache has been filled so far.
    pub fn fills(&self) -> CacheFills {
        self.fills
    }

    /// Of the mesh that is drawn.
    pub fn statistics(&self) -> MeshStatistics {
        self.statistics
    }

    fn prepare_mask(&mut self, gpu: &Gpu, aperture: &Aperture) -> bool {
        let is_new = self.aperture != Some(*aperture);
        if is_new {
            self.ghosts.set_aperture(gpu, &self.resources, aperture);
            self.aperture = Some(*aperture);
            self.fills.masks += 1;
        }
        is_new
    }

    fn prepare_mesh(&mut self, gpu: &Gpu, request: &FlareRequest) -> Result<bool, GpuError> {
        let tracing = match request.ghosts {
            Some(ghosts) if ghosts.tracing == TracingDevice::Gpu => Tracing::Gpu(gpu, &self.rays),
            _ => Tracing::Cpu,
        };
        let (parameters, _) = request.ghosts(tracing);
        let key = parameters.map(|parameters| MeshKey {
            lens: Identity(Arc::clone(&request.lens)),
            table: request.table.clone().map(Identity),
            source: parameters.source,
            ghosts: parameters.ghosts,
        });
        if self.mesh == key {
            return Ok(false);
        }
        let start = Instant::now();
        let mesh = match &parameters {
            Some(parameters) => flare_mesh(parameters)?,
            None => FlareMesh::default(),
        };
        self.statistics = MeshStatistics {
            triangles: mesh.triangles(),
            area_mm2: mesh.area_mm2(),
            make_ms: start.elapsed().as_secs_f64() * 1e3,
        };
        self.ghosts.set_mesh(gpu, &mesh);
        self.mesh = key;
        self.fills.meshes += u32::from(parameters.is_some());
        Ok(true)
    }

    fn prepare_images(&mut self, gpu: &Gpu, request: &FlareRequest) -> bool {
        let evaluated = match (request.ghosts(Tracing::Cpu).1, &request.table) {
            (Some((images, is_photo)), Some(table)) => {
                let light = &request.light;
                let each = images.evaluate(light.angle, light.azimuth).into_iter();
                each.map(|image| (image, is_photo, Identity(Arc::clone(table))))
                    .collect()
            }
            _ => Vec::new(),
        };
        let mut before = std::mem::take(&mut self.images);
        let mut changed = before.len() != evaluated.len();
        for (evaluated, is_photo, table) in evaluated {
            let image = evaluated.image;
            let key = ImageKey {
                table,
                is_photo,
                index: evaluated.index,
            };
            let known = before.iter().position(|(known, _)| *known == key);
            changed |= known != Some(0);
            let mut sprite = match known {
                Some(index) => before.remove(index).1,
                None => {
                    self.fills.images += 1;
                    Sprite::new(gpu, &self.resources, image.size, &image.radiance())
                }
            };
            let (min, max) = (DVec2::from_array(image.min_mm), DVec2::from_array(image.max_mm));
            let frame = SpriteFrame {
                centre_mm: (0.5 * (min + max)).as_vec2().to_array(),
                half_mm: (0.5 * (max - min)).as_vec2().to_array(),
                rotation: DVec2::from_angle(evaluated.rotation).as_vec2().to_array(),
                image_half_mm: request.image_half_mm.map(|half| half as f32),
                radiance: [0.0; 3],
                padding: 0.0,
            };
            let irradiance = request.light.visible_irradiance();
            let factor = irradiance.map(|channel| channel * evaluated.fraction);
            changed |= sprite.set(gpu, frame, factor);
            self.images.push((key, sprite));
        }
        changed
    }

    fn prepare_starburst(&mut self, gpu: &Gpu, request: &FlareRequest) -> bool {
        let Some(parameters) = request.starburst else {
            return self.starburst.take().is_some();
        };
        let focal_mm = Paraxial::new(&request.lens, D_LINE_UM, None).efl_mm.abs();
        let optics = StarburstOptics {
            aperture: request.aperture,
            f_number: request.f_number,
            focal_mm,
            angular_radius: request.light.angular_radius,
        };
        let known = self
            .starburst
            .take()
            .filter(|known| known.optics == optics && known.parameters == parameters);
        let mut starburst = known.unwrap_or_else(|| {
            self.fills.starbursts += 1;
            let pattern = StarburstPattern::new(&optics, parameters);
            let sprite = |size: usize, radiance: &[[f32; 3]]| {
                Sprite::new(gpu, &self.resources, [size as u32; 2], radiance)
            };
            Starburst {
                optics,
                parameters,
                disc_fraction: pattern.disc_fraction,
                visible_radius: 1.0,
                sprites: [
                    (pattern.half_mm, sprite(pattern.size, &pattern.radiance)),
                    (pattern.glare_half_mm, sprite(pattern.glare_size, &pattern.spikes)),
                    (pattern.glare_half_mm, sprite(pattern.glare_size, &pattern.veil)),
                ],
            }
        });
        let mut changed = false;
        // Far from a disc the light of its starburst falls with the cube of the distance, on average, and does not depend on its
        // size: that of a smaller disc with as much light is the same made smaller and brighter. The veil stays as it is.
        // Nor does a disc that is drawn whole become smaller.
        let smaller = if parameters.with_disc {
            1.0
        } else {
            request.light.visible_radius()
        };
        for ((half_mm, sprite), smaller) in starburst.sprites.iter_mut().zip([smaller, smaller, 1.0]) {
            let irradiance = request.light.visible_irradiance();
            let factor = irradiance.map(|channel| channel / smaller.powi(3));
            let frame = SpriteFrame {
                centre_mm: request.light.image_mm(focal_mm).as_vec2().to_array(),
                half_mm: [(*half_mm * smaller) as f32; 2],
                rotation: [1.0, 0.0],
                image_half_mm: request.image_half_mm.map(|half| half as f32),
                radiance: [0.0; 3],
                padding: 0.0,
            };
            changed |= sprite.set(gpu, frame, factor);
        }
        starburst.visible_radius = smaller;
        self.starburst = Some(starburst);
        changed
    }
}
