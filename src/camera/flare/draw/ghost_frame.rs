//! What the ghosts' shader takes: of a target, and of each ghost.

use bytemuck::{Pod, Zeroable};

/// Layout of `FlareFrame` in `shaders/camera/ghost.wgsl`, where each field is explained.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct FlareFrame {
    pub half_mm: [f32; 2],
    pub centre_mm: [f32; 2],
    pub irradiance: [f32; 3],
    pub padding: f32,
}

impl FlareFrame {
    /// For a target that shows this, with a viewport so many times as large.
    pub fn guarded(self, sides: f32) -> Self {
        Self {
            half_mm: self.half_mm.map(|half| half * sides),
            ..self
        }
    }
}

/// A ghost's attributes in `shaders/camera/ghost.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GhostRecord {
    /// Its centre on the sensor, millimetres.
    pub centre_mm: [f32; 2],
    /// How much it is enlarged about that.
    pub enlarged: [f32; 2],
    /// Radii of the discs that soften it, in the iris and on the front, in their own.
    pub soft: [f32; 2],
}

impl GhostRecord {
    /// As `shaders/camera/ghost.wgsl` takes them.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
        wgpu::vertex_attr_array![5 => Float32x2, 6 => Float32x2, 7 => Float32x2];
    /// As it is.
    pub const PLAIN: Self = Self {
        centre_mm: [0.0; 2],
        enlarged: [1.0; 2],
        soft: [0.0; 2],
    };
}
