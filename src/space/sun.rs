//! The sun as a light: one value, made once and handed down to everything that it lights.

use std::f64::consts::PI;

use glam::{DVec3, dvec3};

use super::sun_position::direction_from_azimuth_altitude;
use super::{Place, SunError, sun_direction_in_world};

/// Half the angle that the sun's disc spans, radians: the nominal solar radius, 695,700 km, by the astronomical unit,
/// 149,597,870.7 km (IAU 2015 resolution B3, IAU 2012 resolution B2). Over the year it changes by 1.7 %.
pub const SOLAR_ANGULAR_RADIUS: f64 = 695_700.0 / 149_597_870.7;

/// Irradiance of a high sun on a surface facing it, linear sRGB. The unit is the image's: white plaster in full sun comes near
/// 1 after tone mapping. Plausible, not measured: an atmosphere model can take the place of both colours.
const HIGH_SUN: DVec3 = dvec3(3.83, 3.58, 3.14);
/// The same on the horizon, reddened by its long path through the air.
const LOW_SUN: DVec3 = dvec3(4.02, 1.70, 0.565);
/// Sine of the altitude above which the sun no longer reddens.
const HIGH_SINE: f64 = 0.45;
/// Sines of the altitudes between which the sun comes up: its disc, and what refraction lifts.
const RISING_SINES: [f64; 2] = [-0.02, 0.08];

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
}

impl Sun {
    /// From its direction, a unit vector.
    pub fn from_direction(to_sun: DVec3) -> Self {
        let smooth = |from: f64, to: f64| {
            let fraction = ((to_sun.z - from) / (to - from)).clamp(0.0, 1.0);
            fraction * fraction * (3.0 - 2.0 * fraction)
        };
        let [below, above] = RISING_SINES;
        Self {
            to_sun,
            irradiance: LOW_SUN.lerp(HIGH_SUN, smooth(0.0, HIGH_SINE)) * smooth(below, above),
            angular_radius: SOLAR_ANGULAR_RADIUS,
            visible_fraction: 1.0,
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

    /// The same sun behind what leaves `fraction` of its disc visible.
    #[must_use]
    pub fn with_visible_fraction(self, fraction: f64) -> Self {
        Self {
            visible_fraction: fraction,
            ..self
        }
    }
}
