//! A part of an image, drawn by itself.

use glam::DVec2;

/// A rectangle of an image's pixels; it may reach beyond the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageWindow {
    /// Column and row of its first pixel, from the image's top left.
    pub first: [i32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

impl ImageWindow {
    /// All of an image of `size` pixels.
    pub fn whole(size: [u32; 2]) -> Self {
        Self { first: [0; 2], size }
    }

    /// Its centre and half its size in the normalised device coordinates of an image of `image` pixels.
    pub fn centre_and_half(&self, image: [u32; 2]) -> [DVec2; 2] {
        let image = DVec2::from_array(image.map(f64::from));
        let size = DVec2::from_array(self.size.map(f64::from));
        let first = DVec2::from_array(self.first.map(f64::from));
        let centre = (2.0 * first + size) / image - 1.0;
        [centre * DVec2::new(1.0, -1.0), size / image]
    }
}
