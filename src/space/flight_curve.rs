//! A smooth flight through keyed poses.
//!
//! Positions lie on a centripetal Catmull-Rom spline, which has neither cusps nor loops (Yuksel, Schaefer & Keyser 2011,
//! "Parameterization and applications of Catmull-Rom curves"), evaluated by the pyramid of Barry & Goldman (1988). Attitudes go through
//! the same pyramid with spherical linear interpolation (Shoemake 1985) in the place of the linear one; the camera stays level.
//! How far along the spline the flight is follows time by a monotone curve: it never goes back.

use glam::{DMat3, DQuat, DVec3};

use super::{MonotoneCurve, Pose};

/// A curve through poses.
#[derive(Clone, Debug)]
pub struct FlightCurve {
    /// Parameter, eye and attitude of the keys, one more before the first and after the last.
    knots: Vec<(f64, DVec3, DQuat)>,
    parameter_at: MonotoneCurve,
}

/// Least parameter between two keys: where the eye stands still the attitude needs some. Square root of metres.
const MIN_INTERVAL: f64 = 0.05;

impl FlightCurve {
    /// Through poses at times (seconds) that increase.
    pub fn new(keys: &[(f64, Pose)]) -> Self {
        let mut knots: Vec<(f64, DVec3, DQuat)> = Vec::new();
        for (_, pose) in keys {
            let mut attitude = attitude_of(pose);
            let mut parameter = 0.0;
            if let Some((before, eye, last)) = knots.last() {
                parameter = before + eye.distance(pose.eye).sqrt().max(MIN_INTERVAL);
                // The nearer of the two quaternions that are one rotation.
                if last.dot(attitude) < 0.0 {
                    attitude = -attitude;
                }
            }
            knots.push((parameter, pose.eye, attitude));
        }
        let times = keys.iter().map(|(time, _)| *time);
        let parameter_at = MonotoneCurve::new(
            times
                .zip(&knots)
                .map(|(time, (parameter, ..))| [time, *parameter]),
        );
        // The ends go on as they came.
        let mirrored = |(at, eye, attitude): (f64, DVec3, DQuat), next: (f64, DVec3, DQuat)| {
            (
                2.0 * at - next.0,
                2.0 * eye - next.1,
                attitude * next.2.inverse() * attitude,
            )
        };
        if let [first, second, ..] = *knots.as_slice() {
            let (last, before) = (knots[knots.len() - 1], knots[knots.len() - 2]);
            knots.insert(0, mirrored(first, second));
            knots.push(mirrored(last, before));
        }
        Self { knots, parameter_at }
    }

    /// The pose at a time, seconds; that of the nearest end before the first key and after the last, none without keys.
    pub fn at(&self, time: f64) -> Option<Pose> {
        if self.knots.len() < 4 {
            let (_, eye, attitude) = self.knots.first()?;
            return Some(Pose::looking_along(*eye, *attitude * DVec3::Y));
        }
        let u = self.parameter_at.at(time)?;
        let segments = self.knots.len() - 3;
        let after = self.knots.partition_point(|knot| knot.0 <= u);
        let first = after.saturating_sub(2).min(segments - 1);
        let four = [0, 1, 2, 3].map(|k| self.knots[first + k]);
        let at = four.map(|knot| knot.0);
        let eye = pyramid(at, four.map(|knot| knot.1), u, |a, b, s| a.lerp(b, s));
        let attitude = pyramid(at, four.map(|knot| knot.2), u, |a, b, s| {
            a.slerp(b, s).normalize()
        });
        Some(Pose::looking_along(eye, attitude * DVec3::Y))
    }
}

/// The rotation that turns x, y, z into right, forward, up.
fn attitude_of(pose: &Pose) -> DQuat {
    DQuat::from_mat3(&DMat3::from_cols(pose.right, pose.forward, pose.up))
}

/// Barry and Goldman's pyramid: the value at `u` between the second and the third of four knots.
fn pyramid<T: Copy>(at: [f64; 4], values: [T; 4], u: f64, between: impl Fn(T, T, f64) -> T) -> T {
    let mix = |a: T, b: T, from: f64, to: f64| between(a, b, (u - from) / (to - from));
    let first = [0, 1, 2].map(|k| mix(values[k], values[k + 1], at[k], at[k + 1]));
    let second = [0, 1].map(|k| mix(first[k], first[k + 1], at[k], at[k + 2]));
    mix(second[0], second[1], at[1], at[2])
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
            assert!((next - turned).abs() < 0.15, "the rotation changes from {turned} to {next} at {time}");
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
