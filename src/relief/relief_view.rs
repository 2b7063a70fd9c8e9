//! What the relief pass draws: one sample of one view.

use super::settings::ReliefSettings;
use crate::gpu::Band;
use crate::space::{Projection, Sun};

/// One sample of one view.
#[derive(Clone, Copy, Debug)]
pub struct ReliefView<'a> {
    /// Pose and image, the sample's jitter in it.
    pub projection: &'a Projection,
    /// The sun.
    pub sun: &'a Sun,
    /// Part of the sun's light that its disc in the sky has; the lens spreads the rest.
    pub disc_fraction: f64,
    /// Number of the sample, from 0.
    pub sample: u32,
    /// How the city is drawn.
    pub settings: ReliefSettings,
    /// The rows to draw; the ground and polygons are drawn with the first ones, for all.
    pub band: Band,
}
