//! The sun bounds on the device: remade when the sun, the tiles or the eye's neighbourhood change.

use std::time::{Duration, Instant};

use glam::{DVec2, DVec3, Vec4};

use super::sun_bounds::{MAX_SUN_LEVELS, SUN_CELLS, SunBounds};
use crate::gpu::{Gpu, GpuError, LayerPool};
use crate::scene::Resident;
use crate::space::Sun;

/// Bounds, and what they are of.
pub struct SunBoundsTexture {
    /// A layer a level.
    pub images: LayerPool,
    bounds: Option<SunBounds>,
    /// Whether the bounds are of what was asked for last.
    is_current: bool,
    key: Option<Key>,
    /// When the key came to be what it is.
    since: Instant,
}

/// Tiles, sun, centre.
type Key = (u64, DVec3, f64, DVec2);

/// In a window nothing changes for so long before bounds are made: they take longer than a frame in motion may.
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
            is_current: false,
            key: None,
            since: Instant::now(),
        })
    }

    /// Makes them for a view. Where frames do not wait, only once nothing has changed for a while: until then every ray is cast.
    pub fn prepare(&mut self, gpu: &Gpu, resident: &Resident, sun: &Sun, eye: DVec2) {
        let texel_m = resident.texel_m;
        let drift = DRIFT * texel_m * SUN_CELLS as f64;
        let centre = match self.key {
            Some((.., centre)) if centre.distance(eye) <= drift => centre,
            _ => eye,
        };
        let key = (resident.version(), sun.to_sun, sun.angular_radius, centre);
        if self.key != Some(key) {
            (self.key, self.since, self.is_current) = (Some(key), Instant::now(), false);
        }
        let is_settled = !resident.streams() || self.since.elapsed() >= SETTLED;
        if self.is_current || !is_settled {
            return;
        }
        self.is_current = true;
        self.bounds = SunBounds::new(&resident.tiles, sun, centre, texel_m);
        for (layer, heights) in (0..).zip(self.bounds.iter().flat_map(|bounds| bounds.levels())) {
            self.images.write(gpu, layer, 0, heights);
        }
    }

    /// What shaders take for an eye in plan; no levels while there are none of this view.
    pub fn uniforms(&self, eye: DVec2) -> ([Vec4; 2], u32) {
        match self.bounds.as_ref().filter(|_| self.is_current) {
            Some(bounds) => bounds.uniforms(eye),
            None => ([Vec4::ZERO; 2], 0),
        }
    }
}
