//! Parts of an image that ghosts touch, in blocks of texels.

use glam::{DVec2, UVec2};

/// Texels along a side of a block.
const SIDE: u32 = 16;

/// Blocks of an image, its margin among them.
#[derive(Clone, Debug)]
pub struct TouchedBlocks {
    /// Pixels along a side.
    side_px: f64,
    count: UVec2,
    touched: Vec<bool>,
}

impl TouchedBlocks {
    /// None touched: an image of so many pixels, its texels as many pixels large.
    pub fn new(size_px: DVec2, texel_px: u32) -> Self {
        let side_px = f64::from(SIDE * texel_px);
        // One block beside the image to each side.
        let count = (size_px / side_px).ceil().as_uvec2() + 2;
        Self {
            side_px,
            count,
            touched: vec![false; (count.x * count.y) as usize],
        }
    }

    /// Touches what lies between least and greatest pixels.
    pub fn touch(&mut self, [min_px, max_px]: [DVec2; 2]) {
        let last = self.count.as_dvec2() - 1.0;
        let block = |px: DVec2| (px / self.side_px).floor() + 1.0;
        let (min, max) = (block(min_px), block(max_px));
        if max.min_element() < 0.0 || (min - last).max_element() > 0.0 {
            return;
        }
        let [min, max] = [min, max].map(|block| block.clamp(DVec2::ZERO, last).as_uvec2());
        for y in min.y..=max.y {
            let row = (y * self.count.x) as usize;
            self.touched[row + min.x as usize..=row + max.x as usize].fill(true);
        }
    }

    /// Least and greatest pixels of the touched parts; none overlaps another.
    pub fn parts(&self) -> Vec<[DVec2; 2]> {
        let mut parts: Vec<[UVec2; 2]> = Vec::new();
        for (y, row) in self.touched.chunks_exact(self.count.x as usize).enumerate() {
            let y = y as u32;
            let mut at = 0;
            for run in row.chunk_by(|a, b| a == b) {
                let (from, to) = (at, at + run.len() as u32);
                at = to;
                if !run[0] {
                    continue;
                }
                // As wide as one that ends above it.
                let above = parts
                    .iter_mut()
                    .find(|[min, max]| (min.x, max.x, max.y) == (from, to, y));
                match above {
                    Some([_, max]) => max.y = y + 1,
                    None => parts.push([UVec2::new(from, y), UVec2::new(to, y + 1)]),
                }
            }
        }
        let px = |block: UVec2| (block.as_dvec2() - 1.0) * self.side_px;
        parts.into_iter().map(|part| part.map(px)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pixel that was touched lies in one part, and no pixel in two.
    #[test]
    fn parts_cover_once_what_is_touched() {
        let size = DVec2::new(301.0, 170.0);
        for texel_px in [1, 2, 8] {
            let mut blocks = TouchedBlocks::new(size, texel_px);
            let mut state = 1_u32;
            let mut below = |end: f64| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(state >> 8) / f64::from(1 << 24) * end
            };
            let touched: Vec<[DVec2; 2]> = (0..12)
                .map(|_| {
                    let min = DVec2::new(below(340.0), below(200.0)) - 20.0;
                    [min, min + DVec2::new(below(40.0), below(30.0))]
                })
                .collect();
            touched.iter().for_each(|&area| blocks.touch(area));
            let parts = blocks.parts();
            let is_in = |at: DVec2, [min, max]: [DVec2; 2]| at.cmpge(min).all() && at.cmplt(max).all();
            for y in 0..170 {
                for x in 0..301 {
                    let at = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
                    let count = parts.iter().filter(|&&part| is_in(at, part)).count();
                    assert!(count <= 1, "{at} lies in {count} parts");
                    let is_touched = touched.iter().any(|&area| is_in(at, area));
                    assert!(count == 1 || !is_touched, "{at} is left out");
                }
            }
        }
    }
}
