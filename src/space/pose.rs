//! The camera's pose, and the projection that an optical system makes of it. No optics here (see `camera`).

use glam::{DMat4, DVec2, DVec3, DVec4, Mat4};

use super::ImageWindow;

/// Where the eye is and how it is turned. World axes: x east, y north, z up, metres; the three directions are unit vectors at
/// right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Eye, metres in the city's CRS.
    pub eye: DVec3,
    /// To the right of the image.
    pub right: DVec3,
    /// To the top of the image.
    pub up: DVec3,
    /// Into the scene.
    pub forward: DVec3,
}

/// A pose with an image: everything needed to turn pixels into rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// The pose.
    pub pose: Pose,
    /// Image width and height, pixels.
    pub size: [u32; 2],
    /// The part of the image that is drawn.
    pub window: ImageWindow,
    /// Tangent of half the vertical field of view.
    pub tan_half_fov_y: f64,
    /// Sub-pixel offset of the sample, pixels; (0, 0) is the pixel's centre.
    pub jitter: DVec2,
}

/// Nearest distance drawn, metres.
const NEAR_M: f64 = 0.05;
/// Cosine of the angle from the vertical below which the horizon no longer tells what is right.
const VERTICAL: f64 = 1.0 - 1e-12;

impl Pose {
    /// A level camera at `eye` that looks at `target`; straight up or down, north is the top of the image.
    pub fn looking_at(eye: DVec3, target: DVec3) -> Self {
        Self::looking_along(eye, target - eye)
    }

    /// A level camera at `eye` that looks in a direction of any length.
    pub fn looking_along(eye: DVec3, direction: DVec3) -> Self {
        let forward = direction.normalize_or(DVec3::Y);
        let right = forward
            .cross(DVec3::Z)
            .try_normalize()
            .filter(|_| forward.z.abs() < VERTICAL)
            .unwrap_or(DVec3::X);
        Self {
            eye,
            right,
            up: right.cross(forward),
            forward,
        }
    }
}

impl Projection {
    /// A pinhole's, for an image of `size` pixels and a vertical field of view in radians.
    pub fn new(pose: Pose, size: [u32; 2], fov_y: f64) -> Self {
        Self {
            pose,
            size,
            window: ImageWindow::whole(size),
            tan_half_fov_y: (0.5 * fov_y).tan(),
            jitter: DVec2::ZERO,
        }
    }

    fn aspect(&self) -> f64 {
        f64::from(self.size[0]) / f64::from(self.size[1])
    }

    /// Tangents of half the horizontal and half the vertical field of view.
    pub fn tan_half_fov(&self) -> DVec2 {
        DVec2::new(self.tan_half_fov_y * self.aspect(), self.tan_half_fov_y)
    }

    /// Unit direction of the ray through pixel (column, row), row 0 at the top.
    pub fn ray_direction(&self, column: u32, row: u32) -> DVec3 {
        let centre = DVec2::new(f64::from(column), f64::from(row)) + 0.5;
        self.direction_at(centre + self.jitter)
    }

    /// Unit direction of the ray through a point of the image, pixels from its top left corner.
    pub fn direction_at(&self, point: DVec2) -> DVec3 {
        let size = DVec2::from_array(self.size.map(f64::from));
        let ndc = (2.0 * point / size - 1.0) * DVec2::new(1.0, -1.0);
        let Pose {
            right, up, forward, ..
        } = self.pose;
        let tan = ndc * self.tan_half_fov();
        (forward + right * tan.x + up * tan.y).normalize()
    }

    /// The ray through (x, y) of the window, -1 to 1 from its left to its right edge and from its lower to its upper one, is the first
    /// vector + x times the second + y times the third.
    pub fn window_rays(&self) -> [DVec3; 3] {
        let [centre, half] = self.window.centre_and_half(self.size);
        let tan = self.tan_half_fov();
        let Pose {
            right, up, forward, ..
        } = self.pose;
        let (across, upward) = (right * tan.x, up * tan.y);
        [
            forward + across * centre.x + upward * centre.y,
            across * half.x,
            upward * half.y,
        ]
    }

    /// Clip space of the window from eye-relative world: reversed-Z with an infinite far plane
    /// (depth = near / distance along the view axis).
    pub fn clip_from_eye_relative(&self) -> Mat4 {
        let tan = self.tan_half_fov();
        let [width, height] = self.size.map(f64::from);
        // A sample offset by +jitter moves the image by -jitter.
        let jitter = DVec2::new(-2.0 * self.jitter.x / width, 2.0 * self.jitter.y / height);
        let [centre, half] = self.window.centre_and_half(self.size);
        let shift = (jitter - centre) / half;
        let clip_from_view = DMat4::from_cols(
            DVec4::new(1.0 / tan.x / half.x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0 / tan.y / half.y, 0.0, 0.0),
            DVec4::new(shift.x, shift.y, 0.0, 1.0),
            DVec4::new(0.0, 0.0, NEAR_M, 0.0),
        );
        let Pose {
            right, up, forward, ..
        } = self.pose;
        let view_from_eye_relative = DMat4::from_cols(
            DVec4::new(right.x, up.x, forward.x, 0.0),
            DVec4::new(right.y, up.y, forward.y, 0.0),
            DVec4::new(right.z, up.z, forward.z, 0.0),
            DVec4::W,
        );
        (clip_from_view * view_from_eye_relative).as_mat4()
    }
}
