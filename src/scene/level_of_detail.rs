//! Which tiles a view wants: the quadtree's tiles, cut where a finer level would show nothing more.

use glam::{DVec2, DVec3};

use super::Frustum;
use crate::space::{Bounds, Projection, Sun, TileGrid, TileId};

/// A texel of a building map may be as large as this part of a pixel where a coarse level stands for outlines.
const MAP_TEXEL_PIXELS: f64 = 0.03125;
/// Terrain may depart by this part of a pixel.
const TERRAIN_PIXELS: f64 = 0.0078125;
/// An imagery texel may be as large as this part of a pixel.
const IMAGERY_PIXELS: f64 = 1.0;
/// What is not in view may be as much coarser: the sun and the cursor meet it at most.
const UNSEEN: f64 = 32.0;
/// How far a shadow into the view is followed, metres.
const MAX_SHADOW_M: f64 = 4000.0;

/// A view as the choice of tiles needs it.
pub struct DetailView {
    grid: TileGrid,
    eye: DVec3,
    frustum: Frustum,
    /// Angle of a pixel, radians, times the factor by which detail is given up.
    pixel_angle: f64,
    /// Lowest and highest surface of the city, metres.
    heights: [f64; 2],
    /// From what casts a shadow to where it ends, at most, metres.
    shadow: DVec2,
}

impl DetailView {
    /// Of a projection. `coarser`: a factor on the errors allowed. `heights`: lowest and highest surface of the city, metres.
    pub fn new(grid: TileGrid, projection: &Projection, sun: &Sun, heights: [f64; 2], coarser: f64) -> Self {
        let plan = sun.to_sun.truncate();
        let length = (heights[1] - heights[0]) * plan.length() / sun.to_sun.z.max(1e-3);
        Self {
            grid,
            eye: projection.pose.eye,
            frustum: Frustum::new(projection),
            pixel_angle: coarser * 2.0 * projection.tan_half_fov().y / f64::from(projection.size[1]),
            heights,
            shadow: -plan.normalize_or_zero() * length.min(MAX_SHADOW_M),
        }
    }

    /// Distance from the eye to a tile's volume, metres.
    fn distance(&self, bounds: &Bounds) -> f64 {
        let [low, high] = self.heights;
        let above = (low - self.eye.z).max(self.eye.z - high).max(0.0);
        bounds.distance_to(self.eye.truncate()).hypot(above)
    }

    /// True when a tile, or its shadow, may be in view.
    pub fn is_seen(&self, bounds: &Bounds) -> bool {
        let moved = Bounds {
            west: bounds.west + self.shadow.x,
            south: bounds.south + self.shadow.y,
            east: bounds.east + self.shadow.x,
            north: bounds.north + self.shadow.y,
        };
        self.frustum
            .sees(&bounds.union(&moved), self.heights[0], self.heights[1])
    }

    /// The size of a pixel at a tile, metres: at its nearest point; larger where it is not seen.
    fn pixel_m(&self, id: TileId) -> f64 {
        let bounds = self.grid.tile_bounds(id);
        let factor = if self.is_seen(&bounds) { 1.0 } else { UNSEEN };
        factor * self.pixel_angle * self.distance(&bounds)
    }

    /// Building-map tiles wanted. `texel_m`: side of a texel of level 0.
    pub fn maps(&self, texel_m: f64) -> Vec<TileId> {
        self.leaves(|id| texel_m * f64::from(1_u32 << id.level) > MAP_TEXEL_PIXELS * self.pixel_m(id))
    }

    /// Terrain tiles wanted. `errors`: of the tiles of level 1 and above, metres.
    pub fn terrain(&self, errors: &[Vec<f32>]) -> Vec<TileId> {
        let error = |id: TileId| {
            let [columns, _] = self.grid.counts(id.level);
            let of_level = errors.get(id.level as usize - 1)?;
            of_level.get(id.y as usize * columns + id.x as usize).copied()
        };
        self.leaves(|id| {
            let error = error(id).map_or(f64::INFINITY, f64::from);
            error > TERRAIN_PIXELS * self.pixel_m(id)
        })
    }

    /// Imagery tiles wanted. `pixel_m`: side of a pixel of level 0.
    pub fn imagery(&self, pixel_m: f64) -> Vec<TileId> {
        self.leaves(|id| pixel_m * f64::from(1_u32 << id.level) > IMAGERY_PIXELS * self.pixel_m(id))
    }

    /// The tiles at which the quadtree is cut: those of level 0 and those that need not be finer.
    fn leaves(&self, is_too_coarse: impl Fn(TileId) -> bool) -> Vec<TileId> {
        let root = TileId {
            level: self.grid.levels() - 1,
            x: 0,
            y: 0,
        };
        let (mut leaves, mut open) = (Vec::new(), vec![root]);
        while let Some(id) = open.pop() {
            if id.level > 0 && is_too_coarse(id) {
                open.extend(
                    self.grid
                        .children(id)
                        .into_iter()
                        .filter(|&child| self.grid.contains(child)),
                );
            } else {
                leaves.push(id);
            }
        }
        leaves
    }

    /// In which order tiles are loaded: what is seen before what is not, then the nearest.
    pub fn rank(&self, id: TileId) -> (bool, f64) {
        let bounds = self.grid.tile_bounds(id);
        (!self.is_seen(&bounds), self.distance(&bounds))
    }
}
