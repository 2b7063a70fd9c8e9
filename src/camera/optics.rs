//! The camera as one value: where it is, and what makes its image. It gives the projection, and the sun's position on the sensor.

use std::sync::Arc;

use glam::DVec3;

use super::Paraxial;
use super::flare::FlareLight;
use super::lens::{D_LINE_UM, Lens, LensError};
use crate::space::{Pose, Projection, Sun};

/// Full frame: width and height of the sensor behind a lens where nothing else is said, millimetres.
pub const FULL_FRAME_MM: [f64; 2] = [36.0, 24.0];

/// A camera.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Where it is and how it is turned.
    pub pose: Pose,
    /// What makes its image.
    pub optics: Optics,
}

/// What makes a camera's image.
#[derive(Clone, Debug)]
pub enum Optics {
    /// A pinhole: sharp everywhere.
    Pinhole {
        /// Vertical field of view, radians.
        fov_y: f64,
    },
    /// A lens before a sensor, focused far away.
    Lens(LensOptics),
}

/// How far beyond the widest an f-number may be: they are named in round figures, such as 2.8 for 2.95.
const ROUNDED: f64 = 0.06;

/// Cosine from the axis, at least, of a direction that has an image: what lies beside or behind the camera has one far away.
const MIN_AHEAD: f64 = 1e-6;

/// Refuses an f-number that a lens does not open to.
///
/// # Errors
/// `TooWide`.
pub fn require_f_number(lens: &Lens, f_number: f64) -> Result<(), LensError> {
    match Paraxial::new(lens, D_LINE_UM, None).widest_f_number(lens) {
        Some(widest) if f_number < widest * (1.0 - ROUNDED) => Err(LensError::TooWide {
            name: lens.name.clone(),
            f_number,
            widest,
        }),
        _ => Ok(()),
    }
}

/// A lens before a sensor.
#[derive(Clone, Debug)]
pub struct LensOptics {
    /// The prescription.
    pub lens: Arc<Lens>,
    /// The f-number.
    pub f_number: f64,
    /// Effective focal length at the d line, millimetres.
    pub focal_mm: f64,
    /// Width and height of the sensor, millimetres.
    pub sensor_mm: [f64; 2],
    /// Vertical field of view that the image is cropped to, radians; none for all that the sensor has.
    pub crop_fov_y: Option<f64>,
}

impl LensOptics {
    /// A lens whose image fills what an image's proportions leave of the sensor.
    pub fn new(lens: Arc<Lens>, f_number: f64, sensor_mm: [f64; 2]) -> Self {
        Self {
            focal_mm: Paraxial::new(&lens, D_LINE_UM, None).efl_mm.abs(),
            lens,
            f_number,
            sensor_mm,
            crop_fov_y: None,
        }
    }

    /// The largest vertical field of view that the sensor gives an image of `size` pixels, radians.
    pub fn max_fov_y(&self, size: [u32; 2]) -> f64 {
        2.0 * (self.sensor_half_mm(size)[1] / self.focal_mm).atan()
    }

    /// Half the largest part of the sensor with the proportions of an image, millimetres.
    fn sensor_half_mm(&self, size: [u32; 2]) -> [f64; 2] {
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let [width, height] = self.sensor_mm;
        let half_height = 0.5 * height.min(width / aspect);
        [half_height * aspect, half_height]
    }

    /// Half the part of the sensor that an image of `size` pixels shows, millimetres.
    pub fn image_half_mm(&self, size: [u32; 2]) -> [f64; 2] {
        let whole = self.sensor_half_mm(size);
        let Some(fov_y) = self.crop_fov_y else {
            return whole;
        };
        let cropped = self.focal_mm * (0.5 * fov_y).tan();
        let scale = (cropped / whole[1]).min(1.0);
        whole.map(|half| scale * half)
    }
}

impl Camera {
    /// A pinhole camera; `fov_y` is its vertical field of view, radians.
    pub fn pinhole(pose: Pose, fov_y: f64) -> Self {
        Self {
            pose,
            optics: Optics::Pinhole { fov_y },
        }
    }

    /// Vertical field of view of an image of `size` pixels, radians.
    pub fn fov_y(&self, size: [u32; 2]) -> f64 {
        match &self.optics {
            Optics::Pinhole { fov_y } => *fov_y,
            Optics::Lens(lens) => 2.0 * (lens.image_half_mm(size)[1] / lens.focal_mm).atan(),
        }
    }

    /// Rays of an image of `size` pixels.
    pub fn projection(&self, size: [u32; 2]) -> Projection {
        Projection::new(self.pose, size, self.fov_y(size))
    }

    /// The lens, where there is one.
    pub fn lens(&self) -> Option<&LensOptics> {
        match &self.optics {
            Optics::Pinhole { .. } => None,
            Optics::Lens(lens) => Some(lens),
        }
    }

    /// The sun as light that falls on the camera.
    pub fn light_from(&self, sun: &Sun) -> FlareLight {
        let Pose {
            right, up, forward, ..
        } = self.pose;
        let in_camera = |direction: DVec3| DVec3::from([right, up, forward].map(|axis| direction.dot(axis)));
        let [angle, azimuth] = FlareLight::angle_azimuth(in_camera(sun.to_sun));
        let [centre, visible] = [sun.to_sun, sun.to_visible].map(|direction| {
            let direction = in_camera(direction);
            direction.truncate() / direction.z.max(MIN_AHEAD)
        });
        FlareLight {
            angle,
            azimuth,
            angular_radius: sun.angular_radius,
            irradiance: sun.irradiance.to_array(),
            visible_fraction: sun.visible_fraction,
            visible_offset: visible - centre,
        }
    }
}
