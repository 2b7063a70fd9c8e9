//! How much of the sun an eye sees: rays over the solar disc, past the terrain and the buildings.

use glam::DVec3;

use super::cast::is_open;
use crate::scene::TileSet;
use crate::space::Sun;

/// Rays over the disc.
const DISC_RAYS: u32 = 256;
/// The golden angle, radians.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// The sun as an eye (world, metres) sees it: its visible part is that of its disc.
pub fn sun_seen_from(tiles: &TileSet, eye: DVec3, sun: &Sun) -> Sun {
    let side = sun.to_sun.any_orthonormal_vector();
    let across = sun.to_sun.cross(side);
    let rays = (0..DISC_RAYS).map(|k| {
        // Fibonacci's spiral: points of equal fractions of the disc (Vogel 1979).
        let radius = sun.angular_radius * ((f64::from(k) + 0.5) / f64::from(DISC_RAYS)).sqrt();
        let (sin, cos) = (f64::from(k) * GOLDEN_ANGLE).sin_cos();
        (sun.to_sun + radius * (cos * side + sin * across)).normalize()
    });
    let seen: Vec<DVec3> = rays.filter(|ray| is_open(tiles, eye, *ray)).collect();
    let to_visible = seen.iter().sum::<DVec3>().normalize_or(sun.to_sun);
    sun.with_visible_part(seen.len() as f64 / f64::from(DISC_RAYS), to_visible)
}
