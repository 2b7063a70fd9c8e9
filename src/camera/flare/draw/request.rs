//! What flare is asked for: the lens and its setting, the light in the camera, the image.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::camera::flare::{
    Aperture, FlareParameters, FlareSource, GhostParameters, GhostTable, ImageTable, Pattern, PlayedPatterns,
    StarburstParameters, Tracing,
};
use crate::camera::lens::Lens;

/// Least radius of a visible part by that of the disc: a smaller one, and its starburst, are drawn as if it were so large.
const MIN_VISIBLE_RADIUS: f64 = 0.25;

/// A distant disc of light as the camera sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlareLight {
    /// From the optical axis, radians.
    pub angle: f64,
    /// Direction in the image, from +x (right) towards +y (up), radians.
    pub azimuth: f64,
    /// Of the disc, radians.
    pub angular_radius: f64,
    /// On a surface facing it when nothing hides it, linear sRGB, in units of the image's radiance times steradians.
    pub irradiance: [f64; 3],
    /// Of the disc, 0 to 1.
    pub visible_fraction: f64,
    /// From the image of the disc's centre to that of the centre of its visible part, by the focal length.
    pub visible_offset: DVec2,
}

impl FlareLight {
    /// A point of irradiance 1, wholly visible, at an angle and azimuth, radians.
    pub fn point(angle: f64, azimuth: f64) -> Self {
        Self {
            angle,
            azimuth,
            angular_radius: 0.0,
            irradiance: [1.0; 3],
            visible_fraction: 1.0,
            visible_offset: DVec2::ZERO,
        }
    }

    /// Angle and azimuth of a direction in the camera: x right, y up, z ahead.
    pub fn angle_azimuth(direction: DVec3) -> [f64; 2] {
        let aside = direction.truncate();
        [aside.length().atan2(direction.z), aside.y.atan2(aside.x)]
    }

    /// Whether light falls on the front of the lens.
    pub fn is_lit(&self) -> bool {
        self.visible_fraction > 0.0 && self.angle < std::f64::consts::FRAC_PI_2
    }

    /// What is left of the irradiance.
    pub fn visible_irradiance(&self) -> [f64; 3] {
        self.irradiance.map(|channel| channel * self.visible_fraction)
    }

    /// Where the image of its visible part lies on the sensor of a lens of a focal length, millimetres, x right and y up.
    pub fn image_mm(&self, focal_mm: f64) -> DVec2 {
        focal_mm * (self.angle.tan() * DVec2::from_angle(self.azimuth) + self.visible_offset)
    }

    /// Radius of a disc as large as the visible part, by that of the whole disc.
    pub fn visible_radius(&self) -> f64 {
        self.visible_fraction.sqrt().clamp(MIN_VISIBLE_RADIUS, 1.0)
    }
}

/// What to draw. Copies are cheap.
#[derive(Clone, Debug)]
pub struct FlareRequest {
    /// The lens; another one is told by its address.
    pub lens: Arc<Lens>,
    /// The f-number.
    pub f_number: f64,
    /// The iris.
    pub aperture: Aperture,
    /// How ghosts are made; none are drawn without.
    pub ghosts: Option<GhostParameters>,
    /// How the starburst is made; none is drawn without.
    pub starburst: Option<StarburstParameters>,
    /// Ghosts made beforehand for the same lens and f-number; another table is told by its address.
    pub table: Option<Arc<GhostTable>>,
    /// The light.
    pub light: FlareLight,
    /// Half the image on the sensor, millimetres.
    pub image_half_mm: [f64; 2],
}

impl FlareRequest {
    /// What makes the ghosts' mesh, and the images that are drawn beside it, with whether they are photos. None where the table holds all of the flare, or
    /// no ghosts are asked for.
    pub(super) fn ghosts<'a>(
        &'a self,
        tracing: Tracing<'a>,
    ) -> (Option<FlareParameters<'a>>, Option<(&'a ImageTable, bool)>) {
        let Some(ghosts) = self.ghosts else {
            return (None, None);
        };
        let table = self.table.as_ref();
        let played = table.map_or(PlayedPatterns::NONE, |table| {
            table.at(self.light.angle, ghosts.photographed)
        });
        let pattern = match played.rest {
            Pattern::Whole => ghosts.pattern,
            other => other,
        };
        let has_mesh = played.images.is_none_or(|(images, _)| images.with_linear);
        let parameters = has_mesh.then_some(FlareParameters {
            lens: &self.lens,
            source: FlareSource {
                angle: self.light.angle,
                azimuth: self.light.azimuth,
                f_number: self.f_number,
                angular_radius: self.light.angular_radius,
            },
            ghosts: GhostParameters { pattern, ..ghosts },
            table: played.rays,
            tracing,
        });
        (parameters, played.images)
    }
}
