//! One square tile grid serves terrain, buildings and orthophotos.
//!
//! Level 0 is the finest; a tile of level L+1 covers 2 x 2 tiles of level L. Columns count from the
//! west edge, rows from the south edge, so that local coordinates grow east and north.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::Bounds;

/// Names one tile: quadtree level, column from the west, row from the south.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TileId {
    /// Quadtree level, 0 = finest.
    pub level: u32,
    /// Column, counted from the west.
    pub x: u32,
    /// Row, counted from the south.
    pub y: u32,
}

impl TileId {
    /// The tile of the next coarser level that it lies in.
    pub fn parent(self) -> Self {
        Self {
            level: self.level + 1,
            x: self.x / 2,
            y: self.y / 2,
        }
    }
}

/// The level-0 grid: its south-west corner, the side of a tile and how many there are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TileGrid {
    /// Easting of the west edge, metres.
    pub west: f64,
    /// Northing of the south edge, metres.
    pub south: f64,
    /// Side of a level-0 tile, metres.
    pub tile_m: f64,
    /// Number of tiles east-west.
    pub columns: u32,
    /// Number of tiles north-south.
    pub rows: u32,
}

impl TileGrid {
    /// The grid of tiles of side `tile_m` that covers `bounds`, its corner at a whole number of
    /// `step` metres from `anchor`, so that rasters of that step keep their phase.
    pub fn covering(bounds: &Bounds, tile_m: f64, anchor: DVec2, step: f64) -> Self {
        let snap = |value: f64, phase: f64| ((value - phase) / step).floor() * step + phase;
        let west = snap(bounds.west, anchor.x);
        let south = snap(bounds.south, anchor.y);
        Self {
            west,
            south,
            tile_m,
            columns: ((bounds.east - west) / tile_m).ceil().max(1.0) as u32,
            rows: ((bounds.north - south) / tile_m).ceil().max(1.0) as u32,
        }
    }

    /// The whole grid's rectangle.
    pub fn bounds(&self) -> Bounds {
        Bounds {
            west: self.west,
            south: self.south,
            east: self.west + self.tile_m * f64::from(self.columns),
            north: self.south + self.tile_m * f64::from(self.rows),
        }
    }

    /// Levels of the quadtree over the grid: one tile of the last covers it.
    pub fn levels(&self) -> u32 {
        self.columns.max(self.rows).next_power_of_two().ilog2() + 1
    }

    /// Side of a tile of a level, metres.
    pub fn level_tile_m(&self, level: u32) -> f64 {
        self.tile_m * f64::from(1_u32 << level)
    }

    /// South-west corner of a tile.
    pub fn origin(&self, tile: TileId) -> DVec2 {
        let tile_m = self.level_tile_m(tile.level);
        DVec2::new(
            self.west + tile_m * f64::from(tile.x),
            self.south + tile_m * f64::from(tile.y),
        )
    }

    /// Rectangle of a tile; a coarse one may reach beyond the grid.
    pub fn tile_bounds(&self, tile: TileId) -> Bounds {
        let (origin, tile_m) = (self.origin(tile), self.level_tile_m(tile.level));
        Bounds {
            west: origin.x,
            south: origin.y,
            east: origin.x + tile_m,
            north: origin.y + tile_m,
        }
    }

    /// The four tiles below one of a level above 0, row by row from the south-west; those beyond the grid hold nothing.
    pub fn children(&self, tile: TileId) -> [TileId; 4] {
        std::array::from_fn(|k| TileId {
            level: tile.level - 1,
            x: 2 * tile.x + k as u32 % 2,
            y: 2 * tile.y + k as u32 / 2,
        })
    }

    /// True when a tile lies at least in part on the grid.
    pub fn contains(&self, tile: TileId) -> bool {
        let first = |index: u32| u64::from(index) << tile.level;
        first(tile.x) < u64::from(self.columns) && first(tile.y) < u64::from(self.rows)
    }

    /// Columns and rows of a level.
    pub fn counts(&self, level: u32) -> [usize; 2] {
        [self.columns, self.rows].map(|count| count.div_ceil(1 << level) as usize)
    }

    /// All tiles of a level, row by row from the south-west.
    pub fn tiles_of_level(&self, level: u32) -> impl Iterator<Item = TileId> + use<> {
        let [columns, rows] = self.counts(level).map(|count| count as u32);
        (0..rows).flat_map(move |y| (0..columns).map(move |x| TileId { level, x, y }))
    }

    /// All level-0 tiles, row by row from the south-west.
    pub fn tiles(&self) -> impl Iterator<Item = TileId> + use<> {
        self.tiles_of_level(0)
    }

    /// Level-0 tiles that share area or border with `bounds`.
    pub fn tiles_meeting(&self, bounds: &Bounds) -> impl Iterator<Item = TileId> + use<> {
        let column = |x: f64| ((x - self.west) / self.tile_m).floor();
        let row = |y: f64| ((y - self.south) / self.tile_m).floor();
        let clamp = |value: f64, count: u32| value.clamp(0.0, f64::from(count)) as u32;
        let x0 = clamp(column(bounds.west), self.columns);
        let x1 = clamp(column(bounds.east) + 1.0, self.columns);
        let y0 = clamp(row(bounds.south), self.rows);
        let y1 = clamp(row(bounds.north) + 1.0, self.rows);
        (y0..y1).flat_map(move |y| (x0..x1).map(move |x| TileId { level: 0, x, y }))
    }

    /// Column and row, fractional, of a point; inside the grid when both are within the counts.
    pub fn position(&self, point: DVec2) -> DVec2 {
        DVec2::new(point.x - self.west, point.y - self.south) / self.tile_m
    }

    /// The level-0 tile under a point, or none outside the grid. The far edges belong to the last tile.
    pub fn tile_at(&self, point: DVec2) -> Option<TileId> {
        let at = self.position(point);
        let inside = |value: f64, count: u32| (0.0..=f64::from(count)).contains(&value);
        if !inside(at.x, self.columns) || !inside(at.y, self.rows) {
            return None;
        }
        Some(TileId {
            level: 0,
            x: (at.x as u32).min(self.columns - 1),
            y: (at.y as u32).min(self.rows - 1),
        })
    }
}
