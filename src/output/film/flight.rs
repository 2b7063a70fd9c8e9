//! The view at any time of a flight.

use glam::DVec3;
use jiff::Timestamp;

use super::FlightPath;
use crate::camera::{Camera, Optics};
use crate::space::{FlightCurve, MonotoneCurve, Place, Pose, Sun, SunError, sun_direction_at};

/// A flight path as curves over time.
#[derive(Clone, Debug)]
pub struct Flight {
    curve: FlightCurve,
    /// Logarithms of the field of view (degrees), the f-number and the exposure; seconds of the sun's instant.
    fov: MonotoneCurve,
    f_number: MonotoneCurve,
    exposure: MonotoneCurve,
    sun_seconds: MonotoneCurve,
    /// Seconds of the first and the last key.
    span: [f64; 2],
}

/// What the camera sees at a time; none of what no key says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlightView {
    /// Eye, metres in the city's CRS.
    pub eye: DVec3,
    /// A point that it looks at.
    pub target: DVec3,
    /// Vertical field of view, degrees.
    pub fov_deg: Option<f64>,
    /// The lens's f-number.
    pub f_number: Option<f64>,
    /// Factor on the light before tone mapping.
    pub exposure: Option<f64>,
    /// The sun's instant.
    pub instant: Option<Timestamp>,
}

/// How far ahead the point looked at is, metres.
const TARGET_M: f64 = 100.0;

impl FlightView {
    /// Its pose: that of a still with the same eye and target.
    pub fn pose(&self) -> Pose {
        Pose::looking_at(self.eye, self.target)
    }

    /// The camera, with `optics` where the flight says nothing else.
    pub fn camera(&self, optics: &Optics) -> Camera {
        let mut optics = optics.clone();
        match &mut optics {
            Optics::Pinhole { fov_y } => *fov_y = self.fov_deg.map_or(*fov_y, f64::to_radians),
            Optics::Lens(lens) => {
                lens.f_number = self.f_number.unwrap_or(lens.f_number);
                lens.crop_fov_y = self.fov_deg.map(f64::to_radians).or(lens.crop_fov_y);
            }
        }
        Camera {
            pose: self.pose(),
            optics,
        }
    }

    /// The sun over a place; `sun` where the flight names no time.
    ///
    /// # Errors
    /// When the instant is too far from today.
    pub fn sun_or(&self, sun: Sun, place: Place) -> Result<Sun, SunError> {
        match self.instant {
            Some(instant) => sun_direction_at(instant, place).map(Sun::from_direction),
            None => Ok(sun),
        }
    }

    /// Factor on the light; `exposure` where the flight names none.
    pub fn exposure_or(&self, exposure: f32) -> f32 {
        self.exposure.map_or(exposure, |factor| factor as f32)
    }
}

impl Flight {
    /// Through the keys of a path; none without any.
    pub fn new(path: &FlightPath) -> Option<Self> {
        let times: Vec<f64> = path.times().collect();
        let poses: Vec<(f64, Pose)> = times
            .iter()
            .zip(&path.keys)
            .map(|(&time, key)| (time, key.pose()))
            .collect();
        let curve = |value: &dyn Fn(usize) -> Option<f64>| {
            MonotoneCurve::new((0..times.len()).filter_map(|k| Some([times[k], value(k)?])))
        };
        let key = |k: usize| &path.keys[k];
        let instant = |k: usize| key(k).time.as_ref()?.parse::<Timestamp>().ok();
        Some(Self {
            span: [*times.first()?, *times.last()?],
            fov: curve(&|k| key(k).fov.map(f64::ln)),
            f_number: curve(&|k| key(k).f_number.map(f64::ln)),
            exposure: curve(&|k| key(k).exposure.map(f64::ln)),
            sun_seconds: curve(&|k| instant(k).map(|instant| instant.as_millisecond() as f64 * 1e-3)),
            curve: FlightCurve::new(&poses),
        })
    }

    /// Seconds of the first and the last key.
    pub fn span(&self) -> [f64; 2] {
        self.span
    }

    /// The view at a time, seconds; before the first key and after the last that of the nearest.
    pub fn at(&self, time: f64) -> FlightView {
        let time = time.clamp(self.span[0], self.span[1]);
        let pose = self
            .curve
            .at(time)
            .unwrap_or(Pose::looking_along(DVec3::ZERO, DVec3::Y));
        let value = |curve: &MonotoneCurve| curve.at(time).map(f64::exp);
        let instant = |seconds: f64| Timestamp::from_millisecond((seconds * 1e3).round() as i64).ok();
        FlightView {
            eye: pose.eye,
            target: pose.eye + TARGET_M * pose.forward,
            fov_deg: value(&self.fov),
            f_number: value(&self.f_number),
            exposure: value(&self.exposure),
            instant: self.sun_seconds.at(time).and_then(instant),
        }
    }

    /// Frames at so many a second, the first at the first key.
    pub fn frame_count(&self, frames_per_s: f64) -> u32 {
        // A flight of ten seconds at 30 a second has 300; a still has one.
        ((self.span[1] - self.span[0]) * frames_per_s).round().max(1.0) as u32
    }

    /// Seconds of a frame.
    pub fn frame_time(&self, frame: u32, frames_per_s: f64) -> f64 {
        self.span[0] + f64::from(frame) / frames_per_s
    }
}
