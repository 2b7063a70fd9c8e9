//! The source of light, and the corners of the triangles that it makes.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use super::Wavelength;

/// A distant small source, and the camera that sees it.
#[derive(Clone, Copy, Debug)]
pub struct FlareSource {
    /// Angle from the axis, radians.
    pub angle: f64,
    /// Direction in the picture, from +x (right) towards +y (up), radians.
    pub turn: f64,
    /// Irradiance on a surface facing it, linear sRGB, in units of the picture's radiance times steradians.
    pub irradiance: [f64; 3],
    /// The camera's f-number.
    pub f_number: f64,
    /// Wavelengths.
    pub wavelengths: usize,
    /// Rays along a side of a traced grid.
    pub rays: usize,
    /// Draw quads over the whole front of the lens, not its effective pupil alone: the same picture by more work.
    pub whole_entrance: bool,
}

/// A corner of a ghost's triangle; layout of the vertex buffer of `shaders/camera/flare.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FlareVertex {
    /// On the picture, millimetres of the sensor, x right and y up (the sensor's image turned upright).
    pub sensor_mm: [f32; 2],
    /// In the stop, as a share of its radius at this f-number.
    pub stop: [f32; 2],
    /// In the lens barrel: over length 1 the ray is held.
    pub barrel: [f32; 2],
    /// Radiance added.
    pub radiance: [f32; 3],
    /// Share of what lies below that is hidden, where ghosts are laid over others.
    pub opacity: f32,
}

/// From a beam in the x-z plane to the picture.
pub fn turned(at: DVec2, source: &FlareSource) -> [f32; 2] {
    DVec2::from_angle(source.turn).rotate(at).as_vec2().to_array()
}

/// Radiance that a ghost adds: see `mesh`.
pub fn radiance(source: &FlareSource, colour: Wavelength, power: f64, areas: f64) -> [f32; 3] {
    let scale = power * areas * 4.0 * source.f_number.powi(2) / std::f64::consts::PI;
    [0, 1, 2].map(|channel| (source.irradiance[channel] * colour.rgb[channel] * scale) as f32)
}
