//! The vertices of a ghost's triangles, and the beam they come from.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use crate::camera::flare::Wavelength;

/// Distant light of irradiance 1 into a lens at an f-number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlareSource {
    /// Angle from the axis, radians.
    pub angle: f64,
    /// Direction in the image, from +x (right) towards +y (up), radians.
    pub azimuth: f64,
    /// The f-number.
    pub f_number: f64,
    /// Radius of the light's disc, radians; 0 for a point.
    pub angular_radius: f64,
}

/// A vertex of a ghost's triangle; layout of the vertex buffer of `shaders/camera/ghost.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FlareVertex {
    /// On the image, millimetres of the sensor, x right and y up (the sensor's image turned upright).
    pub sensor_mm: [f32; 2],
    /// In the stop, as a fraction of its radius at this f-number.
    pub stop: [f32; 2],
    /// In the lens barrel: over length 1 the ray is vignetted.
    pub barrel: [f32; 2],
    /// Radiance added for a light of irradiance 1.
    pub radiance: [f32; 3],
    /// Fraction of what lies below that is hidden, where ghosts are blended over others.
    pub opacity: f32,
}

impl FlareVertex {
    /// As `shaders/camera/ghost.wgsl` takes them.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 5] = wgpu::vertex_attr_array![
        0 => Float32x2, 1 => Float32x2, 2 => Float32x2, 3 => Float32x3, 4 => Float32
    ];
}

impl FlareSource {
    /// From a beam in the x-z plane to the image.
    pub fn rotated(&self, at: DVec2) -> [f32; 2] {
        DVec2::from_angle(self.azimuth).rotate(at).as_vec2().to_array()
    }

    /// Radiance that a ghost of a fraction `power` of the light adds, `areas` times smaller on the sensor than at the
    /// entrance: see `mesh`. The entrance lies across the axis and takes the cosine of the beam.
    pub fn radiance(&self, colour: Wavelength, power: f64, areas: f64) -> [f32; 3] {
        let scale = power * areas * self.angle.cos() * 4.0 * self.f_number.powi(2) / std::f64::consts::PI;
        colour.rgb.map(|channel| (channel * scale) as f32)
    }
}
