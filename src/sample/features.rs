//! What the town is made of.

use glam::DVec2;

use super::shapes::Ring;

/// A building, local metres.
#[derive(Clone, Debug)]
pub struct SampleBuilding {
    /// Outer ring, counter-clockwise.
    pub ring: Ring,
    /// Holes.
    pub holes: Vec<Ring>,
    /// Metres above its lowest corner.
    pub height_m: f64,
    /// Storeys.
    pub storeys: u32,
    /// What it is.
    pub kind: &'static str,
    /// Direction of the ridge; none for a flat roof.
    pub ridge: Option<DVec2>,
}

/// A tree seen from above.
#[derive(Clone, Copy, Debug)]
pub struct Tree {
    /// Trunk.
    pub at: DVec2,
    /// Radius of the crown, metres.
    pub radius: f64,
}
