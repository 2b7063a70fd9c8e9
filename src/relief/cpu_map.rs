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
            let Some(map) = self.city.buildings(id)? else {
                return Ok(None);
            };
            let ground = self.city.terrain(id)?.and_then(|terrain| terrain.ground.range());
            let low = ground
                .map_or(f32::INFINITY, |[low, _]| low)
                .min(map.lowest_base());
            Ok(Some(MapTile {
                pyramid: Pyramid::from_map(&map, low),
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
        let mut reads = 0;
        let hit = walk_city(
            grid,
            (eye_tile.as_ivec2(), eye_in_tile, eye.z as f32),
            self.highest_roof,
            &ray,
            [0.0, reach],
            |tile| self.tile(tile),
            &mut reads,
        );
        (hit, reads)
    }
}
