//! A band of an image's rows, drawn by itself: so that on a slow device there is time for other things between one and the next.

use super::Target;

/// Band number `index` of `count` of about as many rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Band {
    /// From 0, the uppermost.
    pub index: u32,
    /// How many make the image.
    pub count: u32,
}

impl Band {
    /// The whole image.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// Whether it begins the image.
    pub fn is_first(self) -> bool {
        self.index == 0
    }

    /// Whether it ends the image.
    pub fn is_last(self) -> bool {
        self.index + 1 >= self.count
    }

    /// First row and number of rows of an image of `height` rows. Bands begin at even rows, so that those of an image of half the size
    /// are theirs.
    fn rows(self, height: u32) -> [u32; 2] {
        let row = |index: u32| {
            let row = u64::from(height) * u64::from(index) / u64::from(self.count.max(1));
            let row = u32::try_from(row).unwrap_or(height);
            if index >= self.count { height } else { row & !1 }
        };
        [row(self.index), row(self.index + 1) - row(self.index)]
    }

    /// Lets a pass on an image of half the size draw on the band only; `size`: pixels of the whole one.
    pub fn confine_half(self, pass: &mut wgpu::RenderPass<'_>, [width, height]: [u32; 2]) -> bool {
        let [first, rows] = self.rows(height);
        if rows > 0 {
            pass.set_scissor_rect(0, first / 2, width.div_ceil(2), rows.div_ceil(2));
        }
        rows > 0
    }

    /// Lets a pass draw on the band only; false when it has no row of an image of `size` pixels.
    pub fn confine(self, pass: &mut wgpu::RenderPass<'_>, [width, height]: [u32; 2]) -> bool {
        let [first, rows] = self.rows(height);
        if rows > 0 {
            pass.set_scissor_rect(0, first, width, rows);
        }
        rows > 0
    }

    /// The attachment for a pass on the band: the first one clears the image to `value`.
    pub fn attachment(
        self,
        target: &Target,
        value: wgpu::Color,
    ) -> Option<wgpu::RenderPassColorAttachment<'_>> {
        if self.is_first() {
            target.cleared(value)
        } else {
            target.loaded()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_every_row_once() {
        for (height, count) in [(720, 9), (5, 8), (1, 1), (135, 7)] {
            let mut next = 0;
            for index in 0..count {
                let [first, rows] = Band { index, count }.rows(height);
                assert_eq!(first, next);
                assert_eq!(first % 2, if rows > 0 { 0 } else { first % 2 });
                next += rows;
            }
            assert_eq!(next, height);
        }
    }
}
