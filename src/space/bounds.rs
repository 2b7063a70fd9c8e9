//! An axis-aligned rectangle on the ground, metres in one CRS.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// West, south, east and north edge, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Smallest easting.
    pub west: f64,
    /// Smallest northing.
    pub south: f64,
    /// Largest easting.
    pub east: f64,
    /// Largest northing.
    pub north: f64,
}

impl Bounds {
    /// Distance of a point from the rectangle, metres; 0 inside.
    pub fn distance_to(&self, point: DVec2) -> f64 {
        let outside = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
        let dx = outside(point.x, self.west, self.east);
        dx.hypot(outside(point.y, self.south, self.north))
    }

    /// The rectangle that holds nothing; growing it by a point makes it that point.
    pub const EMPTY: Self = Self {
        west: f64::INFINITY,
        south: f64::INFINITY,
        east: f64::NEG_INFINITY,
        north: f64::NEG_INFINITY,
    };

    /// True when no point is inside.
    pub fn is_empty(&self) -> bool {
        !(self.west <= self.east && self.south <= self.north)
    }

    /// Grows to hold the point.
    pub fn include(&mut self, x: f64, y: f64) {
        self.west = self.west.min(x);
        self.south = self.south.min(y);
        self.east = self.east.max(x);
        self.north = self.north.max(y);
    }

    /// The smallest rectangle that holds both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            west: self.west.min(other.west),
            south: self.south.min(other.south),
            east: self.east.max(other.east),
            north: self.north.max(other.north),
        }
    }

    /// The part common to both; empty when they do not meet.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self {
            west: self.west.max(other.west),
            south: self.south.max(other.south),
            east: self.east.min(other.east),
            north: self.north.min(other.north),
        }
    }

    /// Grown by `margin` metres on every side.
    #[must_use]
    pub fn grown(&self, margin: f64) -> Self {
        Self {
            west: self.west - margin,
            south: self.south - margin,
            east: self.east + margin,
            north: self.north + margin,
        }
    }

    /// True when the rectangles share at least a point.
    pub fn meets(&self, other: &Self) -> bool {
        !self.intersection(other).is_empty()
    }

    /// East-west extent, metres.
    pub fn width(&self) -> f64 {
        self.east - self.west
    }

    /// North-south extent, metres.
    pub fn height(&self) -> f64 {
        self.north - self.south
    }

    /// The centre.
    pub fn centre(&self) -> DVec2 {
        DVec2::new(0.5 * (self.west + self.east), 0.5 * (self.south + self.north))
    }
}
