//! Motion that goes on by itself: a flight to a place, and a pan that runs out.

use glam::{DQuat, DVec2, DVec3};

use crate::space::Pose;

/// A flight from one pose to another.
#[derive(Clone, Copy, Debug)]
pub struct Glide {
    from: Pose,
    to: Pose,
    elapsed_s: f64,
}

/// Seconds of a flight to a place.
const GLIDE_S: f64 = 0.7;
/// Part of the distance that is left after it.
const NEARER: f64 = 0.35;
/// Least distance that it leaves, metres.
const NEAREST_M: f64 = 25.0;

impl Glide {
    /// To a pose.
    pub fn new(from: Pose, to: Pose) -> Self {
        Self {
            from,
            to,
            elapsed_s: 0.0,
        }
    }

    /// Towards a point, which comes to the middle of the image.
    pub fn towards(from: Pose, target: DVec3) -> Self {
        let away = from.eye - target;
        let distance = away.length().max(1e-6);
        let wanted = (NEARER * distance).max(NEAREST_M).min(distance.max(NEAREST_M));
        Self::new(
            from,
            Pose::looking_at(target + away * (wanted / distance), target),
        )
    }

    /// Time passes: the pose then, and whether that is the last.
    pub fn pass(&mut self, seconds: f64) -> (Pose, bool) {
        self.elapsed_s += seconds;
        let part = (self.elapsed_s / GLIDE_S).min(1.0);
        if part >= 1.0 {
            return (self.to, true);
        }
        // Begins and ends softly.
        let s = part * part * (3.0 - 2.0 * part);
        let rotation = DQuat::from_rotation_arc(self.from.forward, self.to.forward);
        let turned = DQuat::IDENTITY.slerp(rotation, s) * self.from.forward;
        (
            Pose::looking_along(self.from.eye.lerp(self.to.eye, s), turned),
            false,
        )
    }
}

/// The speed of a drag that was let go.
#[derive(Clone, Copy, Debug, Default)]
pub struct Momentum {
    /// Metres a second in plan.
    velocity: DVec2,
    /// Seconds since the drag moved last.
    idle_s: f64,
}

/// A drag that rested so long before it was let go stays where it is, seconds.
const HELD_S: f64 = 0.08;
/// Speed halves in so long, seconds; below this part of the height above ground a second it stops.
const HALF_LIFE_S: f64 = 0.09;
const STOPS_BELOW: f64 = 0.05;

impl Momentum {
    /// The drag moved the eye in so long.
    pub fn dragged(&mut self, step: DVec2, seconds: f64) {
        let now = step / seconds.max(1e-3);
        self.velocity = self.velocity.lerp(now, 0.5);
        self.idle_s = 0.0;
    }

    /// Time passes while the drag is held.
    pub fn held(&mut self, seconds: f64) {
        self.idle_s += seconds;
        if self.idle_s > HELD_S {
            self.velocity = DVec2::ZERO;
        }
    }

    /// Whether it runs.
    pub fn is_moving(&self) -> bool {
        self.velocity != DVec2::ZERO
    }

    /// Stops.
    pub fn stop(&mut self) {
        *self = Self::default();
    }

    /// Time passes after it was let go: the step of the eye; none when it has stopped. `height_m`: of the eye above the ground.
    pub fn pass(&mut self, seconds: f64, height_m: f64) -> Option<DVec2> {
        if self.velocity.length() < STOPS_BELOW * height_m.max(1.0) {
            self.stop();
            return None;
        }
        let step = self.velocity * seconds;
        self.velocity *= 0.5_f64.powf(seconds / HALF_LIFE_S);
        Some(step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_glide_ends_where_it_was_meant_to() {
        let from = Pose::looking_at(DVec3::new(0.0, 0.0, 400.0), DVec3::new(300.0, 0.0, 0.0));
        let target = DVec3::new(0.0, 200.0, 10.0);
        let mut glide = Glide::towards(from, target);
        let mut last = from;
        for _ in 0..60 {
            let (pose, is_last) = glide.pass(0.02);
            assert!(pose.eye.distance(last.eye) < 40.0, "no jump");
            last = pose;
            if is_last {
                break;
            }
        }
        assert!(last.forward.dot((target - last.eye).normalize()) > 0.999_999);
        assert!((last.eye.distance(target) / from.eye.distance(target) - NEARER).abs() < 1e-9);
    }

    #[test]
    fn a_drag_that_rested_does_not_run_on_and_another_soon_stops() {
        let mut held = Momentum::default();
        held.dragged(DVec2::new(10.0, 0.0), 0.02);
        held.held(0.2);
        assert_eq!(held.pass(0.02, 100.0), None);
        let mut thrown = Momentum::default();
        thrown.dragged(DVec2::new(10.0, 0.0), 0.02);
        let mut seconds = 0.0;
        while thrown.pass(0.02, 100.0).is_some() {
            seconds += 0.02;
        }
        assert!((0.1..1.0).contains(&seconds), "{seconds}");
    }
}
