//! What every pass of a frame is handed.

use super::targets::ReliefTargets;
use crate::gpu::{Band, Gpu, PassTimer};
use crate::scene::{Frustum, Resident};
use crate::space::Projection;

/// One frame in the making.
pub struct PassContext<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Where commands go.
    pub encoder: &'a mut wgpu::CommandEncoder,
    /// The resident city.
    pub resident: &'a Resident,
    /// Pose and image.
    pub projection: &'a Projection,
    /// What the projection sees.
    pub frustum: Frustum,
    /// Group 0: the frame's uniforms.
    pub frame: &'a wgpu::BindGroup,
    /// Group 1: the city.
    pub city: &'a wgpu::BindGroup,
    /// Images of the frame.
    pub targets: &'a ReliefTargets,
    /// The rows to draw.
    pub band: Band,
    /// Times of the passes.
    pub timer: &'a PassTimer,
}

/// The relief's timed passes: their names by their numbers.
pub const TIMED_PASSES: [&str; 3] = ["ground", "buildings", "light"];

/// The numbers of the relief's timed passes.
pub mod pass_number {
    /// The ground.
    pub const GROUND: u32 = 0;
    /// The buildings, with the cone prepass.
    pub const BUILDINGS: u32 = 1;
    /// Light.
    pub const LIGHT: u32 = 2;
}
