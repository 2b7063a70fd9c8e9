//! Overflow: what rises beyond the rectangle's own pixels.

use glam::{DVec2, DVec3};

/// Where the view ray through a point of an upright face meets the plane, by how far out over the border and how far along it.
/// `dx`: the point's height over the plane; `dy`: its distance along the border; `view`: the view direction, x out over the border, y
/// along it, z down (claims 7, 19 and 26). Twin: `virtual_extension` in `shaders/relief/extrusion.wgsl`.
pub fn virtual_extension(dx: f64, dy: f64, view: DVec3) -> DVec2 {
    DVec2::new(dx * view.x / view.z, dx * view.y / view.z + dy)
}

/// The borders of a rectangle (west, east, south, north) over which what stands on it may overflow for an eye: those that it sees from
/// within. Before a corner two; before a side the one behind and the two beside it, from above all four. `eye`: from the rectangle's south-west corner, metres.
pub fn faces_seen(eye: DVec2, size_m: DVec2) -> [bool; 4] {
    [eye.x > 0.0, eye.x < size_m.x, eye.y > 0.0, eye.y < size_m.y]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the meeting of a ray and a plane, computed in world space, at all four borders: the face's tangent space is the plane's,
    /// turned.
    #[test]
    fn the_virtual_extension_is_where_the_ray_meets_the_plane() {
        let borders = [
            (DVec3::new(0.0, 3.0, 1.2), -DVec3::X, DVec3::Y),
            (DVec3::new(10.0, 3.0, 0.4), DVec3::X, DVec3::Y),
            (DVec3::new(2.0, 0.0, 2.0), -DVec3::Y, DVec3::X),
            (DVec3::new(2.0, 8.0, 0.1), DVec3::Y, DVec3::X),
        ];
        for (point, out, along) in borders {
            for view in [DVec3::new(0.3, -0.5, -0.6), DVec3::new(-0.8, 0.1, -0.2)] {
                let local = DVec3::new(view.dot(out), view.dot(along), -view.z);
                let reached = virtual_extension(point.z, point.dot(along), local);
                let met = point - view * (point.z / view.z);
                let border = point.dot(out);
                assert!((met.dot(out) - border - reached.x).abs() < 1e-12);
                assert!((met.dot(along) - reached.y).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn two_faces_before_a_corner_and_three_before_a_side() {
        let size = DVec2::new(10.0, 8.0);
        let seen = |x, y| faces_seen(DVec2::new(x, y), size);
        assert_eq!(seen(5.0, -20.0), [true, true, false, true]);
        assert_eq!(seen(-20.0, -20.0), [false, true, false, true]);
        assert_eq!(seen(30.0, 4.0), [true, false, true, true]);
    }
}
