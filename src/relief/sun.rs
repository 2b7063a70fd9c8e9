//! How much of the sun an eye sees, by the one traversal over the solar disc: the terrain and the buildings before it.

use glam::DVec3;

use super::CpuMap;
use crate::city::{City, CityError};
use crate::terrain::HeightTile;

/// Half the angle that the sun's disc spans, radians (mean; 15.99 arc minutes).
pub const SUN_RADIUS: f64 = 0.004_65;

/// Rays over the disc.
const DISC_RAYS: u32 = 256;

/// Visible share of the solar disc, 0 to 1, for an eye in world coordinates and a unit vector to the sun's centre.
///
/// # Errors
/// When a terrain tile cannot be read.
pub fn sun_visibility(city: &City, map: &CpuMap<'_>, eye: DVec3, to_sun: DVec3) -> Result<f64, CityError> {
    let ground = Ground::along(city, eye, to_sun)?;
    let side = to_sun.any_orthonormal_vector();
    let across = to_sun.cross(side);
    let mut seen = 0_u32;
    for k in 0..DISC_RAYS {
        // Fibonacci's spiral: points of equal share of the disc (Vogel 1979).
        let radius = SUN_RADIUS * ((f64::from(k) + 0.5) / f64::from(DISC_RAYS)).sqrt();
        let (sin, cos) = (f64::from(k) * 2.399_963_229_728_653).sin_cos();
        let ray = (to_sun + radius * (cos * side + sin * across)).normalize();
        let reach = ground.first_hit(eye, ray);
        if reach.is_none() && map.cast(eye, ray, f32::INFINITY).0.is_none() {
            seen += 1;
        }
    }
    Ok(f64::from(seen) / f64::from(DISC_RAYS))
}

/// Irradiance of the sun on a surface facing it, linear sRGB, in units of the picture's radiance times steradians. Twin:
/// `sun_colour` in `shaders/lib/sky.wgsl`, whose surfaces send on irradiance / 2.5 as radiance.
pub fn sun_irradiance(to_sun: DVec3) -> [f64; 3] {
    let smooth = |from: f64, to: f64| {
        let share = ((to_sun.z - from) / (to - from)).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    };
    let (warm, up) = (smooth(0.0, 0.45), smooth(-0.02, 0.08));
    let mix = |low: f64, high: f64| (low + (high - low) * warm) * up * std::f64::consts::PI / 2.5;
    [mix(3.2, 3.05), mix(1.35, 2.85), mix(0.45, 2.5)]
}

/// The terrain tiles under a direction, near ones first.
struct Ground {
    tiles: Vec<(DVec3, HeightTile)>,
    step_m: f64,
    tile_m: f64,
    top_m: f64,
}

impl Ground {
    fn along(city: &City, eye: DVec3, to_sun: DVec3) -> Result<Self, CityError> {
        let manifest = city.manifest();
        let grid = &manifest.grid;
        let mut ground = Self {
            tiles: Vec::new(),
            step_m: manifest.terrain_step_m,
            tile_m: grid.tile_m,
            top_m: f64::NEG_INFINITY,
        };
        let flat = to_sun.truncate().normalize_or_zero();
        for tile in grid.tiles() {
            let origin = grid.origin(tile);
            // Tiles whose centre lies ahead and near the line of sight.
            let centre = origin + 0.5 * grid.tile_m - eye.truncate();
            let (ahead, aside) = (centre.dot(flat), centre.perp_dot(flat).abs());
            if ahead < -grid.tile_m || aside > grid.tile_m + 0.02 * ahead.max(0.0) {
                continue;
            }
            let Some(terrain) = city.terrain(tile)? else {
                continue;
            };
            let Some([_, high]) = terrain.ground.range() else {
                continue;
            };
            ground.top_m = ground.top_m.max(f64::from(high));
            ground
                .tiles
                .push((origin.extend(f64::from(high)), terrain.ground));
        }
        Ok(ground)
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        let (origin, tile) = self.tiles.iter().find(|(origin, _)| {
            (origin.x..origin.x + self.tile_m).contains(&x) && (origin.y..origin.y + self.tile_m).contains(&y)
        })?;
        tile.ground(x - origin.x, y - origin.y)
    }

    /// Metres along the ray to the first ground, in steps of half a terrain sample.
    fn first_hit(&self, eye: DVec3, ray: DVec3) -> Option<f64> {
        let flat = ray.truncate().length().max(1e-6);
        let step = 0.5 * self.step_m / flat;
        let mut t = step;
        // Past the highest ground, or beyond any city, nothing more can be met.
        while t * flat < 100_000.0 {
            let at = eye + ray * t;
            if ray.z >= 0.0 && at.z > self.top_m {
                return None;
            }
            match self.height(at.x, at.y) {
                Some(height) if height > at.z => return Some(t),
                Some(_) => t += step,
                // No ground here: on by a tile's tenth.
                None => t += 0.1 * self.tile_m / flat,
            }
        }
        None
    }
}
