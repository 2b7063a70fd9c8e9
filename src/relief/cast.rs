//! Rays through the resident city on the CPU: picking, the sun's visible fraction, counting reads, and the tests of the twins.

use glam::{DVec3, Vec3};

use super::ground_march::walk_ground;
use super::march::{Hit, Ray, walk_city};
use super::{GridPosition, SurfaceHit};
use crate::scene::TileSet;

/// First building along a ray from `start` (world, metres) nearer than `max_distance` metres, and the number of reads.
pub fn cast_buildings(
    tiles: &TileSet,
    start: DVec3,
    direction: DVec3,
    max_distance: f32,
) -> (Option<Hit>, u32) {
    let eye = GridPosition::new(&tiles.grid, start);
    let ray = Ray::new(Vec3::ZERO, direction.as_vec3());
    let mut reads = 0;
    let hit = walk_city(tiles, &eye, &ray, [0.0, max_distance], &mut reads);
    (hit, reads)
}

/// Metres to the first ground along a ray from `start` (world, metres), nearer than `max_distance` metres.
pub fn cast_ground(tiles: &TileSet, start: DVec3, direction: DVec3, max_distance: f32) -> Option<f32> {
    let eye = GridPosition::new(&tiles.grid, start);
    let ray = Ray::new(Vec3::ZERO, direction.as_vec3());
    walk_ground(tiles, &eye, &ray, [0.0, max_distance])
}

/// What a ray from `start` (world, metres) meets first: what is to be seen there.
pub fn pick(tiles: &TileSet, start: DVec3, direction: DVec3) -> Option<SurfaceHit> {
    let ground = cast_ground(tiles, start, direction, f32::INFINITY);
    let (building, _) = cast_buildings(tiles, start, direction, ground.unwrap_or(f32::INFINITY));
    match (building, ground) {
        (Some(hit), _) => Some(SurfaceHit {
            t: hit.t,
            fid: hit.fid,
        }),
        (None, Some(t)) => Some(SurfaceHit { t, fid: 0 }),
        (None, None) => None,
    }
}

/// True when a ray meets neither a building nor the ground.
pub fn is_open(tiles: &TileSet, start: DVec3, direction: DVec3) -> bool {
    pick(tiles, start, direction).is_none()
}
