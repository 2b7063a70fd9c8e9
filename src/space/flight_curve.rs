//! A smooth flight through keyed poses.
//!
//! Positions lie on a centripetal Catmull-Rom spline, which has neither cusps nor loops (Yuksel, Schaefer & Keyser 2011,
//! "Parameterization and applications of Catmull-Rom curves"), evaluated by the pyramid of Barry & Goldman (1988). How far along it the
//! flight is follows time by a monotone curve: it never goes back. Heading and pitch follow time by monotone curves as well, each key's
//! heading by the shorter way from the one before: so the camera stays level, and turns no farther than its keys say. (Spherical
//! interpolation of whole rotations tilts it on its way.)

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::{MonotoneCurve, Pose};

/// A curve through poses.
#[derive(Clone, Debug)]
pub struct FlightCurve {
    /// Parameters and eyes of the keys, one more before the first and after the last.
    knots: Vec<(f64, DVec3)>,
    parameter: MonotoneCurve,
    /// Heading, counter-clockwise from east, not wrapped, and pitch above the horizon, radians.
    heading: MonotoneCurve,
    pitch: MonotoneCurve,
}

/// Least parameter between two keys: between equal eyes there must be some. Square root of metres.
const MIN_INTERVAL: f64 = 0.05;
/// Steeper than this (sine) the direction of view no longer tells the heading; what is up in the image does.
const STEEP: f64 = 0.999_999;

impl FlightCurve {
    /// Through poses at times (seconds) that increase.
    pub fn new(keys: &[(f64, Pose)]) -> Self {
        let mut knots: Vec<(f64, DVec3)> = Vec::new();
        let mut headings: Vec<f64> = Vec::new();
        for (_, pose) in keys {
            let parameter = knots.last().map_or(0.0, |(before, eye)| {
                before + eye.distance(pose.eye).sqrt().max(MIN_INTERVAL)
            });
            knots.push((parameter, pose.eye));
            let own = heading_of(pose);
            let unwrapped = |before: &f64| before + (own - before + PI).rem_euclid(TAU) - PI;
            headings.push(headings.last().map_or(own, unwrapped));
        }
        let over_time = |values: &mut dyn Iterator<Item = f64>| {
            MonotoneCurve::new(keys.iter().zip(values).map(|((time, _), value)| [*time, value]))
        };
        let parameter = over_time(&mut knots.iter().map(|knot| knot.0));
        // The ends go on as they came.
        if let [first, second, ..] = *knots.as_slice() {
            let (last, before) = (knots[knots.len() - 1], knots[knots.len() - 2]);
            let mirrored =
                |end: (f64, DVec3), next: (f64, DVec3)| (2.0 * end.0 - next.0, 2.0 * end.1 - next.1);
            knots.insert(0, mirrored(first, second));
            knots.push(mirrored(last, before));
        }
        let pitch = |pose: &Pose| pose.forward.z.clamp(-1.0, 1.0).asin();
        Self {
            parameter,
            heading: over_time(&mut headings.into_iter()),
            pitch: over_time(&mut keys.iter().map(|(_, pose)| pitch(pose))),
            knots,
        }
    }

    /// The pose at a time, seconds; that of the nearest end before the first key and after the last, none without keys.
    pub fn at(&self, time: f64) -> Option<Pose> {
        let (heading, pitch) = (self.heading.at(time)?, self.pitch.at(time)?);
        let level = DVec2::from_angle(heading) * pitch.cos();
        Some(Pose::looking_along(self.eye_at(time)?, level.extend(pitch.sin())))
    }

    fn eye_at(&self, time: f64) -> Option<DVec3> {
        if self.knots.len() < 4 {
            return self.knots.first().map(|knot| knot.1);
        }
        let u = self.parameter.at(time)?;
        let segments = self.knots.len() - 3;
        let after = self.knots.partition_point(|knot| knot.0 <= u);
        let first = after.saturating_sub(2).min(segments - 1);
        let four = [0, 1, 2, 3].map(|k| self.knots[first + k]);
        // The pyramid: between neighbours, then between those of three knots, then all four.
        let mix = |a: DVec3, b: DVec3, from: usize, to: usize| {
            let (from, to) = (four[from].0, four[to].0);
            a.lerp(b, (u - from) / (to - from))
        };
        let one = [0, 1, 2].map(|k| mix(four[k].1, four[k + 1].1, k, k + 1));
        let two = [0, 1].map(|k| mix(one[k], one[k + 1], k, k + 2));
        Some(mix(two[0], two[1], 1, 2))
    }
}

/// Heading of a pose.
fn heading_of(pose: &Pose) -> f64 {
    let level = match pose.forward.z.abs() < STEEP {
        true => pose.forward.truncate(),
        false => pose.up.truncate() * -pose.forward.z.signum(),
    };
    level.y.atan2(level.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(time: f64, eye: [f64; 3], target: [f64; 3]) -> (f64, Pose) {
        (time, Pose::looking_at(eye.into(), target.into()))
    }

    fn keys() -> Vec<(f64, Pose)> {
        vec![
            key(0.0, [0.0, 0.0, 300.0], [400.0, 300.0, 100.0]),
            key(2.0, [350.0, 40.0, 220.0], [400.0, 300.0, 100.0]),
            key(3.0, [360.0, 60.0, 215.0], [400.0, 300.0, 100.0]),
            key(6.0, [900.0, 500.0, 180.0], [400.0, 300.0, 100.0]),
            key(9.0, [900.0, 500.0, 180.0], [1400.0, 300.0, 160.0]),
        ]
    }

    #[test]
    fn it_passes_its_keys() {
        let keys = keys();
        let curve = FlightCurve::new(&keys);
        for (time, pose) in &keys {
            let met = curve
                .at(*time)
                .filter(|met| met.eye.distance(pose.eye) < 1e-6 && met.forward.distance(pose.forward) < 1e-6);
            assert!(met.is_some(), "{time}: {:?}", curve.at(*time));
        }
        assert_eq!(curve.at(-5.0), curve.at(0.0));
        assert_eq!(curve.at(50.0), curve.at(9.0));
    }

    /// Neither position nor direction jumps, and neither turns on the spot: at 240 steps a second a step differs from the one before
    /// by no more than a small part of it.
    #[test]
    fn it_is_smooth_in_position_and_attitude() {
        let curve = FlightCurve::new(&keys());
        let poses: Vec<Pose> = (0..=9 * 240)
            .filter_map(|k| curve.at(f64::from(k) / 240.0))
            .collect();
        assert_eq!(poses.len(), 9 * 240 + 1);
        for (k, three) in poses.windows(3).enumerate() {
            let time = k as f64 / 240.0;
            let speed = three[1].eye.distance(three[0].eye) * 240.0;
            assert!(speed < 500.0, "{speed} m/s at {time}");
            let change = (three[2].eye - 2.0 * three[1].eye + three[0].eye).length() * 240.0;
            assert!(change < 10.0, "speed changes by {change} m/s in a step at {time}");
            let turned = three[1].forward.angle_between(three[0].forward) * 240.0;
            assert!(turned < 3.0, "{turned} radians a second at {time}");
            let next = three[2].forward.angle_between(three[1].forward) * 240.0;
            assert!(
                (next - turned).abs() < 0.15,
                "the rotation changes from {turned} to {next} at {time}"
            );
            assert!(three[0].right.z.abs() < 1e-9, "level at {time}");
        }
    }

    #[test]
    fn a_straight_flight_of_even_speed_stays_one() {
        let along = |k: f64| key(k, [100.0 * k, 0.0, 50.0], [100.0 * k + 10.0, 0.0, 50.0]);
        let curve = FlightCurve::new(&[along(0.0), along(1.0), along(2.0), along(3.0)]);
        for k in 0..=30 {
            let time = f64::from(k) * 0.1;
            let off = curve
                .at(time)
                .map(|pose| pose.eye.distance(DVec3::new(100.0 * time, 0.0, 50.0)));
            assert!(off.is_some_and(|off| off < 1e-6), "{time}: {off:?}");
        }
    }

    #[test]
    fn one_key_is_a_pose_and_none_is_nothing() {
        let keys = keys();
        let alone = FlightCurve::new(&keys[..1]);
        assert!(
            alone
                .at(3.0)
                .is_some_and(|pose| pose.forward.distance(keys[0].1.forward) < 1e-9)
        );
        assert_eq!(FlightCurve::new(&[]).at(0.0), None);
    }
}
