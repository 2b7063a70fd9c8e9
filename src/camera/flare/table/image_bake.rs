//! Draws a table of images of the nonlinear ghosts over the light's angle and azimuth: for apertures without symmetry, whose
//! shape is in the images (KR 10-1658883's table over two parameters).

use std::f64::consts::TAU;

use glam::DVec2;

use super::{ImageTable, LightImage};
use crate::camera::flare::{FlareImager, FlareLight, FlareMode, FlareRequest, GhostParameters, Pattern};
use crate::gpu::GpuError;

/// The angles and azimuths that are drawn.
#[derive(Clone, Copy, Debug)]
pub struct ImageKnots {
    /// Largest angle from the axis, radians.
    pub max_angle: f64,
    /// Number of angles from 0, at least 2.
    pub angles: u32,
    /// Number of azimuths round the axis.
    pub azimuths: u32,
    /// Pixels along a side of an image.
    pub size: u32,
}

/// Draws them with the lens, iris and ghosts of a request.
///
/// # Errors
/// When the device fails.
pub fn bake_images(
    imager: &mut FlareImager<'_>,
    request: &FlareRequest,
    knots: ImageKnots,
) -> Result<ImageTable, GpuError> {
    // A square that holds the film however it is rotated.
    let [width, height] = request.lens.film_mm;
    let (size, half_mm) = ([knots.size; 2], [0.5 * width.hypot(height); 2]);
    let mut images = Vec::new();
    for azimuth in (0..knots.azimuths).map(|k| TAU * f64::from(k) / f64::from(knots.azimuths)) {
        for k in 0..knots.angles {
            let angle = knots.max_angle * f64::from(k) / f64::from(knots.angles.max(2) - 1);
            let nonlinear = FlareRequest {
                ghosts: request.ghosts.map(|ghosts| GhostParameters {
                    pattern: Pattern::Nonlinear,
                    mode: FlareMode::Blended,
                    ..ghosts
                }),
                starburst: None,
                table: None,
                light: FlareLight {
                    angle,
                    azimuth,
                    irradiance: [1.0; 3],
                    visible_fraction: 1.0,
                    visible_offset: DVec2::ZERO,
                    ..request.light
                },
                image_half_mm: half_mm,
                ..request.clone()
            };
            let image = imager.draw(&nonlinear, size)?;
            images.push(LightImage::new(angle, azimuth, &image.radiance, size, half_mm));
        }
    }
    let drawn_for = (request.f_number, request.aperture);
    Ok(ImageTable::new(images, true, Some(drawn_for)))
}
