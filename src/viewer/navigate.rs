//! Navigation: pan on the ground under the cursor, orbit it, zoom to it, fly. Never below the ground.

use glam::{DQuat, DVec2, DVec3};

use crate::relief::{cast_buildings, pick};
use crate::scene::TileSet;
use crate::space::{Pose, Projection};

/// A cursor on an image: what a drag or a step of the wheel acts on.
#[derive(Clone, Copy, Debug)]
pub struct Cursor<'a> {
    /// The image that it is on.
    pub projection: &'a Projection,
    /// Pixels from the image's top left corner.
    pub position: DVec2,
}

/// What a drag does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drag {
    /// The point stays under the cursor.
    Pan { anchor: DVec3 },
    /// The camera turns round the point.
    Orbit { anchor: DVec3, last: DVec2 },
}

/// Where the camera goes.
#[derive(Clone, Debug)]
pub struct Navigator {
    /// The camera's pose.
    pub pose: Pose,
    drag: Option<Drag>,
}

/// Least height of the eye above the ground, metres.
const CLEARANCE_M: f64 = 1.6;
/// Least distance that a flight leaves to walls and roofs, metres.
const WALL_CLEARANCE_M: f64 = 1.0;
/// Least distance that the wheel leaves to what it goes to, metres.
const NEAREST_M: f64 = 2.0;
/// Part of the distance that stays with a step of the wheel.
const ZOOM_STEP: f64 = 0.85;
/// Farthest that a step of the wheel leads from what it goes from, metres.
const FARTHEST_M: f64 = 100_000.0;
/// Where nothing is met, a plane so far below the eye takes the ground's place, metres.
const FALLBACK_DEPTH_M: f64 = 100.0;
/// Rays flatter than this (sine) have no point on the ground to hold on to.
const FLATTEST: f64 = 0.02;
/// Rotation of the camera for a drag over the image's height, radians.
const ROTATION_PER_IMAGE: f64 = 3.0;
/// Steepest and flattest views that orbiting leads to: sines of the altitude of the direction of view.
const PITCH: [f64; 2] = [-0.9998, 0.6];
/// Speed of flight by height above the ground, a second; slowest, metres a second; and how many times faster with Shift.
const SPEED: f64 = 0.8;
const SLOWEST_M_S: f64 = 8.0;
const FAST: f64 = 5.0;

impl Navigator {
    /// At a pose, above the ground.
    pub fn new(tiles: &TileSet, pose: Pose) -> Self {
        let mut navigator = Self { pose, drag: None };
        navigator.stay_above(tiles);
        navigator
    }

    /// What is under a cursor: the city, or a plane below the eye where nothing is met; none near the horizon.
    pub fn point_under(tiles: &TileSet, cursor: Cursor<'_>) -> Option<DVec3> {
        let direction = cursor.projection.direction_at(cursor.position);
        let eye = cursor.projection.pose.eye;
        if let Some(hit) = pick(tiles, eye, direction) {
            return Some(eye + direction * f64::from(hit.t));
        }
        let depth = match tiles.ground_at(eye.truncate()) {
            Some(ground) => (eye.z - ground).max(1.0),
            None => FALLBACK_DEPTH_M,
        };
        (direction.z < -FLATTEST).then(|| eye + direction * (depth / -direction.z))
    }

    /// Takes hold of what is under the cursor, to move it.
    pub fn begin_pan(&mut self, tiles: &TileSet, cursor: Cursor<'_>) {
        self.drag = Self::point_under(tiles, cursor).map(|anchor| Drag::Pan { anchor });
    }

    /// Takes hold of what is under the cursor, to turn round it.
    pub fn begin_orbit(&mut self, tiles: &TileSet, cursor: Cursor<'_>) {
        let ahead = self.pose.eye + self.pose.forward * FALLBACK_DEPTH_M;
        let anchor = Self::point_under(tiles, cursor).unwrap_or(ahead);
        self.drag = Some(Drag::Orbit {
            anchor,
            last: cursor.position,
        });
    }

    /// Lets go.
    pub fn end_drag(&mut self) {
        self.drag = None;
    }

    /// Whether something is held.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Moves what is held with the cursor. True when the pose changed.
    pub fn drag(&mut self, tiles: &TileSet, cursor: Cursor<'_>) -> bool {
        let before = self.pose;
        match self.drag {
            Some(Drag::Pan { anchor }) => self.pan(anchor, cursor),
            Some(Drag::Orbit { anchor, last }) => {
                let height = f64::from(cursor.projection.size[1]);
                let rotation = (cursor.position - last) * (ROTATION_PER_IMAGE / height);
                self.orbit(anchor, rotation);
                self.drag = Some(Drag::Orbit {
                    anchor,
                    last: cursor.position,
                });
            }
            None => {}
        }
        self.stay_above(tiles);
        self.pose != before
    }

    /// The eye moves level, until the anchor lies under the cursor.
    fn pan(&mut self, anchor: DVec3, cursor: Cursor<'_>) {
        let direction = cursor.projection.direction_at(cursor.position);
        let rise = anchor.z - self.pose.eye.z;
        // Through the anchor's own plane only, and not towards the horizon.
        if direction.z.abs() < FLATTEST || direction.z * rise <= 0.0 {
            return;
        }
        let plan = anchor - direction * (rise / direction.z);
        self.pose.eye = DVec3::new(plan.x, plan.y, self.pose.eye.z);
    }

    /// Turns eye and view together round the anchor, which so stays where it is in the image.
    fn orbit(&mut self, anchor: DVec3, rotation_wanted: DVec2) {
        let pitch = self.pose.forward.z;
        let wanted = (pitch.clamp(-1.0, 1.0).asin() - rotation_wanted.y).sin();
        let allowed = wanted.clamp(PITCH[0].min(pitch), PITCH[1].max(pitch));
        let tilt = allowed.asin() - pitch.clamp(-1.0, 1.0).asin();
        let rotation = DQuat::from_axis_angle(DVec3::Z, -rotation_wanted.x)
            * DQuat::from_axis_angle(self.pose.right, tilt);
        let eye = anchor + rotation * (self.pose.eye - anchor);
        self.pose = Pose::looking_along(eye, rotation * self.pose.forward);
    }

    /// Turns the city in the image round what is under the cursor, anticlockwise by an angle (radians), as two fingers on a touchpad do.
    /// True when the pose changed.
    pub fn rotate(&mut self, tiles: &TileSet, cursor: Cursor<'_>, angle: f64) -> bool {
        let Some(anchor) = Self::point_under(tiles, cursor) else {
            return false;
        };
        let before = self.pose;
        self.orbit(anchor, DVec2::new(angle, 0.0));
        self.stay_above(tiles);
        self.pose != before
    }

    /// Goes towards what is under the cursor by steps of the wheel, or away from it. True when the pose changed.
    pub fn zoom(&mut self, tiles: &TileSet, cursor: Cursor<'_>, steps: f64) -> bool {
        let Some(anchor) = Self::point_under(tiles, cursor) else {
            return false;
        };
        let before = self.pose;
        let from_anchor = self.pose.eye - anchor;
        let distance = from_anchor.length();
        let wanted =
            (distance * ZOOM_STEP.powf(steps)).clamp(NEAREST_M.min(distance), FARTHEST_M.max(distance));
        self.pose.eye = anchor + from_anchor * (wanted / distance.max(1e-6));
        self.stay_above(tiles);
        self.pose != before
    }

    /// Flies for `seconds`: to the right, up, and ahead, each -1 to 1. True when the pose changed.
    pub fn fly(&mut self, tiles: &TileSet, wish: DVec3, is_fast: bool, seconds: f64) -> bool {
        if wish == DVec3::ZERO {
            return false;
        }
        let height = tiles
            .ground_at(self.pose.eye.truncate())
            .map_or(FALLBACK_DEPTH_M, |ground| self.pose.eye.z - ground);
        let factor = if is_fast { FAST } else { 1.0 };
        let speed = (SPEED * height).max(SLOWEST_M_S) * factor;
        let direction = self.pose.right * wish.x + DVec3::Z * wish.y + self.pose.forward * wish.z;
        let step = direction.normalize_or_zero() * speed * seconds;
        self.pose.eye += allowed_step(tiles, self.pose.eye, step);
        self.stay_above(tiles);
        true
    }

    /// Goes to a pose, above the ground.
    pub fn go_to(&mut self, tiles: &TileSet, pose: Pose) {
        self.pose = pose;
        self.stay_above(tiles);
    }

    /// Lifts the eye out of the ground.
    fn stay_above(&mut self, tiles: &TileSet) {
        if let Some(ground) = tiles.ground_at(self.pose.eye.truncate()) {
            self.pose.eye.z = self.pose.eye.z.max(ground + CLEARANCE_M);
        }
    }
}

/// What of a step leads through no wall: up to the wall, and on along it.
fn allowed_step(tiles: &TileSet, eye: DVec3, step: DVec3) -> DVec3 {
    let mut left = step;
    let mut taken = DVec3::ZERO;
    // A corner has two walls.
    for _ in 0..3 {
        let length = left.length();
        let direction = left.normalize_or_zero();
        if length <= 0.0 {
            break;
        }
        let from = eye + taken;
        let (hit, _) = cast_buildings(tiles, from, direction, (length + WALL_CLEARANCE_M) as f32);
        let Some(hit) = hit else {
            return taken + left;
        };
        let free = (f64::from(hit.t) - WALL_CLEARANCE_M).clamp(0.0, length);
        taken += free * direction;
        let normal = hit
            .wall_normal
            .map_or(DVec3::Z, |normal| normal.as_dvec2().extend(0.0));
        // The rest without its part into the wall.
        left = (length - free) * direction;
        left -= left.dot(normal).min(0.0) * normal;
    }
    taken
}
