//! The sky of one sun on the device: its radiance by direction, and its light on surfaces (`shaders/lib/sky.wgsl`).

use glam::{DVec3, Vec4};
use half::f16;

use crate::gpu::{Gpu, GpuError, LayerPool};
use crate::space::atmosphere::{Atmosphere, SKY_VIEW_SIZE, SkyIrradiance, SkyTexel};
use crate::space::{SUN_ABOVE_AIR, Sun};

/// Of walls: reflectance, the part of those that face the sun which is in it by the mean cosine there, and the part of the light of level
/// ground that all get of the sky and of one another. Estimates for a street.
const WALL_ALBEDO: f64 = 0.33;
const WALLS_IN_SUN: f64 = 0.56;
const WALLS_SKY: f64 = 0.60;

/// The tables, and for which sun they are.
pub struct SkyTables {
    /// Two layers, `SkyTexel::even` and `SkyTexel::mie`; rows from straight below.
    pub images: LayerPool,
    irradiance: Option<SkyIrradiance>,
    to_sun: DVec3,
}

impl SkyTables {
    /// Unwritten ones.
    ///
    /// # Errors
    /// When the device cannot hold them.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let size = SKY_VIEW_SIZE.map(|side| side as u32);
        let mut images = LayerPool::new(gpu, "sky", wgpu::TextureFormat::Rgba16Float, size, 1)?;
        images.reserve(gpu, 2)?;
        Ok(Self {
            images,
            irradiance: None,
            to_sun: DVec3::ZERO,
        })
    }

    /// Makes them for a sun, unless they are.
    pub fn set_sun(&mut self, gpu: &Gpu, sun: &Sun) {
        let is_known = self.irradiance.is_some() && self.to_sun.z == sun.to_sun.z;
        self.to_sun = sun.to_sun;
        if is_known {
            return;
        }
        let sky = Atmosphere::get().sky_view(sun.to_sun.z);
        let layers: [fn(&SkyTexel) -> DVec3; 2] = [|texel| texel.even, |texel| texel.mie];
        for (layer, part) in (0..).zip(layers) {
            let texel = |texel: &SkyTexel| {
                let [r, g, b] = (part(texel) * SUN_ABOVE_AIR).to_array().map(f16::from_f64);
                [r, g, b, f16::ONE]
            };
            let texels: Vec<[f16; 4]> = sky.texels().iter().map(texel).collect();
            self.images.write(gpu, layer, 0, &texels);
        }
        self.irradiance = Some(SkyIrradiance::new(&sky));
    }

    /// Coefficients of the sky's irradiance for a unit normal in the sun's frame, x towards its azimuth.
    pub fn coefficients(&self) -> [Vec4; 9] {
        let coefficients = self.irradiance.map(|irradiance| irradiance.coefficients);
        let scaled = |k: usize| coefficients.map_or(DVec3::ZERO, |all| all[k] * SUN_ABOVE_AIR);
        std::array::from_fn(|k| scaled(k).as_vec3().extend(0.0))
    }

    /// What walls away from the sun send on to a surface whose view they fill, of the sky's light; and those that face it, of its light at
    /// this hour as well.
    pub fn wall_light(&self) -> [DVec3; 2] {
        let sun = SUN_ABOVE_AIR * Atmosphere::get().sunlight(self.to_sun.z);
        let of_sky = WALLS_SKY * self.on_level_ground();
        [of_sky, of_sky + WALLS_IN_SUN * sun].map(|light| WALL_ALBEDO * light)
    }

    /// Irradiance of level ground by the open sky, linear sRGB.
    pub fn on_level_ground(&self) -> DVec3 {
        let sky = self
            .irradiance
            .map_or(DVec3::ZERO, |irradiance| irradiance.on(DVec3::Z));
        sky * SUN_ABOVE_AIR
    }
}
