//! The sun as a light: one value, made once and handed down to everything that it lights.

use std::f64::consts::PI;

use glam::DVec3;

use super::atmosphere::Atmosphere;
use super::sun_position::direction_from_azimuth_altitude;
use super::{Place, SunError, sun_direction_in_world};

/// Half the angle that the sun's disc spans, radians: the nominal solar radius, 695,700 km, by the astronomical unit,
/// 149,597,870.7 km (IAU 2015 resolution B3, IAU 2012 resolution B2). Over the year it changes by 1.7 %.
pub const SOLAR_ANGULAR_RADIUS: f64 = 695_700.0 / 149_597_870.7;

/// Irradiance of the sun above the air on a surface facing it, linear sRGB: white, because the coefficients of `atmosphere` are for
/// its own colours. The unit is the image's: white plaster in full sun comes near 1 after tone mapping.
pub const SUN_ABOVE_AIR: f64 = 4.4;

/// The sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Unit vector towards the centre of its disc: east, north, up.
    pub to_sun: DVec3,
    /// Irradiance of the whole disc on a surface facing it, linear sRGB.
    pub irradiance: DVec3,
    /// Half the angle that its disc spans, radians.
    pub angular_radius: f64,
    /// The fraction of its disc that the camera sees, 0 to 1; `relief` finds it.
    pub visible_fraction: f64,
    /// Unit vector towards the centre of what the camera sees of it.
    pub to_visible: DVec3,
}

impl Sun {
    /// From its direction, a unit vector.
    pub fn from_direction(to_sun: DVec3) -> Self {
        Self {
            to_sun,
            irradiance: SUN_ABOVE_AIR * Atmosphere::get().sunlight(to_sun.z),
            angular_radius: SOLAR_ANGULAR_RADIUS,
            visible_fraction: 1.0,
            to_visible: to_sun,
        }
    }

    /// From a compass azimuth (degrees clockwise from grid north) and an altitude (degrees).
    pub fn from_azimuth_altitude(azimuth_deg: f64, altitude_deg: f64) -> Self {
        Self::from_direction(direction_from_azimuth_altitude(azimuth_deg, altitude_deg))
    }

    /// At an RFC 3339 time over a place.
    ///
    /// # Errors
    /// When the text is no such time, or too far from today.
    pub fn at_time(time: &str, place: Place) -> Result<Self, SunError> {
        sun_direction_in_world(time, place).map(Self::from_direction)
    }

    /// Radiance of its disc, linear sRGB.
    pub fn disc_radiance(&self) -> DVec3 {
        self.irradiance / (PI * self.angular_radius.sin().powi(2))
    }

    /// The same sun behind what leaves `fraction` of its disc visible, round a direction (unit vector).
    #[must_use]
    pub fn with_visible_part(self, fraction: f64, to_visible: DVec3) -> Self {
        Self {
            visible_fraction: fraction,
            to_visible,
            ..self
        }
    }
}
