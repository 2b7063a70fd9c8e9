//! The camera pose: where the eye is and where it looks. No optics (see `camera`).

use glam::{DMat4, DVec2, DVec3, DVec4, Mat4};

/// A pinhole pose. World axes: x east, y north, z up, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Eye, metres in the city's CRS.
    pub eye: DVec3,
    /// A point looked at, metres in the city's CRS.
    pub look: DVec3,
    /// Vertical field of view, radians.
    pub fov_y: f64,
}

/// A view with an image size: everything needed to turn pixels into rays.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// Unit vector to the right of the image.
    pub right: DVec3,
    /// Unit vector to the top of the image.
    pub up: DVec3,
    /// Unit vector into the scene.
    pub forward: DVec3,
    /// Image width and height, pixels.
    pub size: [u32; 2],
    /// Tangent of half the vertical field of view.
    pub tan_half_fov_y: f64,
    /// Sub-pixel offset of the sample, pixels; (0, 0) is the pixel's centre.
    pub jitter: DVec2,
}

/// Nearest distance drawn, metres.
const NEAR_M: f64 = 0.05;

impl View {
    /// Axes and pixel geometry for an image of `size` pixels.
    /// Looking straight up or down, north is the top of the image.
    pub fn projection(&self, size: [u32; 2]) -> Projection {
        let forward = (self.look - self.eye).normalize_or(DVec3::Y);
        let right = forward
            .cross(DVec3::Z)
            .try_normalize()
            .filter(|_| forward.z.abs() < 1.0 - 1e-12)
            .unwrap_or(DVec3::X);
        Projection {
            right,
            up: right.cross(forward),
            forward,
            size,
            tan_half_fov_y: (0.5 * self.fov_y).tan(),
            jitter: DVec2::ZERO,
        }
    }
}

impl Projection {
    fn aspect(&self) -> f64 {
        f64::from(self.size[0]) / f64::from(self.size[1])
    }

    /// Unit direction of the ray through pixel (column, row), row 0 at the top.
    pub fn ray_direction(&self, column: u32, row: u32) -> DVec3 {
        let [width, height] = self.size.map(f64::from);
        let ndc_x = 2.0 * (f64::from(column) + 0.5 + self.jitter.x) / width - 1.0;
        let ndc_y = 1.0 - 2.0 * (f64::from(row) + 0.5 + self.jitter.y) / height;
        let tan = self.tan_half_fov_y;
        (self.forward + self.right * (ndc_x * tan * self.aspect()) + self.up * (ndc_y * tan)).normalize()
    }

    /// Clip space from eye-relative world: reversed-Z with an infinite far plane
    /// (depth = near / distance along the view axis).
    pub fn clip_from_eye_relative(&self) -> Mat4 {
        let tan = self.tan_half_fov_y;
        let [width, height] = self.size.map(f64::from);
        // A sample offset by +jitter moves the picture by -jitter.
        let shift_x = -2.0 * self.jitter.x / width;
        let shift_y = 2.0 * self.jitter.y / height;
        let clip_from_view = DMat4::from_cols(
            DVec4::new(1.0 / (tan * self.aspect()), 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0 / tan, 0.0, 0.0),
            DVec4::new(shift_x, shift_y, 0.0, 1.0),
            DVec4::new(0.0, 0.0, NEAR_M, 0.0),
        );
        let view_from_eye_relative = DMat4::from_cols(
            DVec4::new(self.right.x, self.up.x, self.forward.x, 0.0),
            DVec4::new(self.right.y, self.up.y, self.forward.y, 0.0),
            DVec4::new(self.right.z, self.up.z, self.forward.z, 0.0),
            DVec4::W,
        );
        (clip_from_view * view_from_eye_relative).as_mat4()
    }
}
