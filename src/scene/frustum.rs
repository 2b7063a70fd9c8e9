//! Leaves out tiles whose volume the view cannot see.

use glam::{DVec3, Vec4};

use crate::space::{Bounds, Projection};

/// The view's side planes, eye-relative: a point is inside when its dot product with each is not negative.
pub struct Frustum {
    planes: [Vec4; 5],
    eye: DVec3,
}

impl Frustum {
    /// From the clip matrix of a projection (Gribb & Hartmann 2001); the far plane is at infinity.
    pub fn new(projection: &Projection) -> Self {
        let clip_from_eye_relative = projection.clip_from_eye_relative();
        let [x, y, w] = [0, 1, 3].map(|row| clip_from_eye_relative.row(row));
        Self {
            planes: [w + x, w - x, w + y, w - y, w],
            eye: projection.pose.eye,
        }
    }

    /// False when the box lies wholly outside one plane.
    pub fn sees(&self, plan: &Bounds, low: f64, high: f64) -> bool {
        let near = DVec3::new(plan.west, plan.south, low) - self.eye;
        let far = DVec3::new(plan.east, plan.north, high) - self.eye;
        self.planes.iter().all(|plane| {
            let corner = |axis: usize| if plane[axis] >= 0.0 { far[axis] } else { near[axis] } as f32;
            plane.dot(Vec4::new(corner(0), corner(1), corner(2), 1.0)) >= 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Pose;

    #[test]
    fn boxes_behind_the_eye_are_left_out_and_those_before_it_kept() {
        let eye = DVec3::new(0.0, 0.0, 50.0);
        let pose = Pose::looking_at(eye, DVec3::new(0.0, 100.0, 40.0));
        let frustum = Frustum::new(&Projection::new(pose, [160, 90], 1.0));
        let at = |south: f64| Bounds {
            west: -5.0,
            south,
            east: 5.0,
            north: south + 10.0,
        };
        assert!(frustum.sees(&at(50.0), 0.0, 60.0));
        assert!(!frustum.sees(&at(-60.0), 0.0, 60.0));
        assert!(frustum.sees(&at(-5.0), 0.0, 60.0), "the eye's own tile");
    }
}
