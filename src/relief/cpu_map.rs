//! A city's building map on the CPU, tile by tile as rays ask for it: picking, counting reads, and the test of the twins.

use std::sync::OnceLock;

use glam::{DVec3, IVec2, Vec2};

use super::march::{Hit, MapTile, Ray, walk_city};
use crate::buildings::Pyramid;
use crate::city::{City, CityError};
use crate::space::TileId;

/// Tiles are read once and kept.
pub struct CpuMap<'a> {
    city: &'a City,
    tiles: Vec<OnceLock<Option<MapTile>>>,
    highest_roof: f32,
}

impl<'a> CpuMap<'a> {
    /// Over an opened city. `highest_roof` bounds upward rays, metres.
    pub fn new(city: &'a City, highest_roof: f32) -> Self {
        let grid = &city.manifest().grid;
        let count = grid.columns as usize * grid.rows as usize;
        Self {
            city,
            tiles: std::iter::repeat_with(OnceLock::new).take(count).collect(),
            highest_roof,
        }
    }

    fn tile(&self, place: IVec2) -> Option<&MapTile> {
        let grid = &self.city.manifest().grid;
        let id = TileId {
            level: 0,
            x: place.x as u32,
            y: place.y as u32,
        };
        let index = (id.y * grid.columns + id.x) as usize;
        let load = || -> Result<Option<MapTile>, CityError> {
            Ok(self.city.buildings(id)?.map(|map| MapTile {
                pyramid: Pyramid::of(&map),
                map,
            }))
        };
        self.tiles
            .get(index)?
            .get_or_init(|| {
                load().unwrap_or_else(|error| {
                    tracing::warn!("{error}");
                    None
                })
            })
            .as_ref()
    }

    /// First building along a ray from `eye` (world, metres) nearer than `reach` metres, and the number of reads.
    pub fn cast(&self, eye: DVec3, direction: DVec3, reach: f32) -> (Option<Hit>, u32) {
        let grid = &self.city.manifest().grid;
        let place = grid.position(eye.truncate());
        let eye_tile = place.floor();
        let eye_in_tile: Vec2 = ((place - eye_tile) * grid.tile_m).as_vec2();
        let ray = Ray::new(glam::Vec3::ZERO, direction.as_vec3());
        // From outside the grid the walk starts where the ray comes in.
        let bounds = grid.bounds();
        let enter = |low: f64, high: f64, from: f64, d: f64| {
            let (near, far) = if d >= 0.0 { (low, high) } else { (high, low) };
            let inverse = 1.0
                / if d.abs() < 1e-9 {
                    1e-9_f64.copysign(d)
                } else {
                    d
                };
            ((near - from) * inverse, (far - from) * inverse)
        };
        let (x0, x1) = enter(bounds.west, bounds.east, eye.x, direction.x);
        let (y0, y1) = enter(bounds.south, bounds.north, eye.y, direction.y);
        let from = x0.max(y0).max(0.0) as f32;
        let mut reads = 0;
        if x0.max(y0) > x1.min(y1) {
            return (None, reads);
        }
        let hit = walk_city(
            grid,
            (eye_tile.as_ivec2(), eye_in_tile, eye.z as f32),
            self.highest_roof,
            &ray,
            [from, reach],
            |tile| self.tile(tile),
            &mut reads,
        );
        (hit, reads)
    }
}
