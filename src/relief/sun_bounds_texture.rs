//! The sun bounds on the device: remade when the sun, the tiles or the eye's neighbourhood change.

use std::time::{Duration, Instant};

use glam::{DVec2, DVec3, Vec4};

use super::beside_frames::BesideFrames;
use super::sun_bounds::{MAX_SUN_LEVELS, SUN_CELLS, SunBounds};
use super::sun_obstacles::SunObstacles;
use crate::gpu::{Gpu, GpuError, LayerPool};
use crate::scene::Resident;
use crate::space::Sun;

/// Bounds, and what they are of.
pub struct SunBoundsTexture {
    /// A layer a level.
    pub images: LayerPool,
    /// The bounds in them, and what they are of.
    bounds: Option<(Key, Option<SunBounds>)>,
    /// What was asked for last.
    key: Option<Key>,
    /// When the key came to be what it is.
    since: Instant,
    /// Bounds in the making, and what of.
    job: BesideFrames<Key, Option<SunBounds>>,
}

/// Tiles, direction to the sun and its radius; centre.
type Key = ((u64, DVec3, f64), DVec2);

/// In a window nothing changes for so long before bounds are made.
const SETTLED: Duration = Duration::from_millis(250);
/// The eye may go so far from the centre, by the finest level's extent.
const DRIFT: f64 = 0.1;

impl SunBoundsTexture {
    /// None yet.
    ///
    /// # Errors
    /// When the device cannot hold them.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let mut images = LayerPool::new(
            gpu,
            "sun bounds",
            wgpu::TextureFormat::R32Float,
            [SUN_CELLS as u32; 2],
            1,
        )?;
        images.reserve(gpu, MAX_SUN_LEVELS as u32)?;
        Ok(Self {
            images,
            bounds: None,
            key: None,
            since: Instant::now(),
            job: BesideFrames::default(),
        })
    }

    /// Makes them for a view. Where frames do not wait, beside them and only once nothing has changed for a while: until then those of
    /// the same tiles and sun serve, or every ray is cast.
    pub fn prepare(&mut self, gpu: &Gpu, resident: &Resident, sun: &Sun, eye: DVec2) {
        let texel_m = resident.texel_m;
        let drift = DRIFT * texel_m * SUN_CELLS as f64;
        let centre = match self.key {
            Some((_, centre)) if centre.distance(eye) <= drift => centre,
            _ => eye,
        };
        let key = ((resident.version(), sun.to_sun, sun.angular_radius), centre);
        if self.key != Some(key) {
            (self.key, self.since) = (Some(key), Instant::now());
        }
        if self.bounds.as_ref().is_some_and(|(of, _)| *of == key) {
            return;
        }
        let make = move |obstacles: SunObstacles, sun: Sun| SunBounds::new(&obstacles, &sun, centre, texel_m);
        if !resident.streams() {
            let bounds = make(SunObstacles::of(&resident.tiles), *sun);
            return self.take(gpu, key, bounds);
        }
        let finished = self.job.finished();
        if let Some((of, bounds)) = finished.filter(|(of, _)| of.0 == key.0) {
            self.take(gpu, of, bounds);
        }
        let is_made = self.bounds.as_ref().is_some_and(|(of, _)| *of == key);
        if !self.job.is_busy() && !is_made && self.since.elapsed() >= SETTLED {
            let (obstacles, sun) = (SunObstacles::of(&resident.tiles), *sun);
            self.job.begin(key, move || make(obstacles, sun));
        }
    }

    fn take(&mut self, gpu: &Gpu, of: Key, bounds: Option<SunBounds>) {
        for (layer, heights) in (0..).zip(bounds.iter().flat_map(|bounds| bounds.levels())) {
            self.images.write(gpu, layer, 0, heights);
        }
        self.bounds = Some((of, bounds));
    }

    /// What shaders take for an eye in plan; no levels while there are none of its tiles and sun. Those round another centre hold as well.
    pub fn uniforms(&self, eye: DVec2) -> ([Vec4; 2], u32) {
        let wanted = self.key.map(|(of, _)| of);
        match &self.bounds {
            Some(((of, _), Some(bounds))) if wanted == Some(*of) => bounds.uniforms(eye),
            _ => ([Vec4::ZERO; 2], 0),
        }
    }
}
