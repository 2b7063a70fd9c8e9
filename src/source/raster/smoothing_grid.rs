//! Nodes at one spacing of a block of pixels, and the sweeps that make their surface taut.

use super::window::Window;

/// Weight of a sweep: below 1 so that a checkerboard fades.
const RELAXATION: f32 = 0.8;

/// Every 2^level-th pixel of a block, counted from the raster's corner.
pub struct Grid {
    level: usize,
    /// Number of the first node, in nodes from the raster's corner.
    pub first: [usize; 2],
    pub size: [usize; 2],
    /// Column and row of the first node's pixel in the window, and the window's columns.
    pixel_first: [usize; 2],
    width: usize,
    pub heights: Vec<f32>,
}

impl Grid {
    /// The nodes of a block of pixels, cut to the window; without heights.
    pub fn new(window: &Window, [low, high]: [[usize; 2]; 2], level: usize) -> Self {
        let stride = 1 << level;
        let first = [0, 1].map(|axis| low[axis].max(window.first[axis]).div_ceil(stride));
        let size = [0, 1].map(|axis| {
            let end = high[axis].min(window.first[axis] + window.size[axis]);
            end.div_ceil(stride).saturating_sub(first[axis])
        });
        Self {
            level,
            first,
            size,
            pixel_first: [0, 1].map(|axis| (first[axis] << level) - window.first[axis]),
            width: window.size[0],
            heights: vec![f32::NAN; size[0] * size[1]],
        }
    }

    /// Indices in the window of the nodes' pixels.
    pub fn pixels(&self) -> impl Iterator<Item = usize> {
        let [columns, rows] = self.size;
        (0..rows).flat_map(move |j| {
            let start = (self.pixel_first[1] + (j << self.level)) * self.width + self.pixel_first[0];
            (0..columns).map(move |i| start + (i << self.level))
        })
    }

    /// Takes the surface of twice the spacing: linear between nodes, missing where none is near.
    pub fn take(&mut self, coarser: &Self) {
        for j in 0..self.size[1] {
            for i in 0..self.size[0] {
                let at = [self.first[0] + i, self.first[1] + j];
                let (mut sum, mut count) = (0.0, 0.0);
                for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    // An odd number lies between two nodes, an even one on one.
                    if (at[0].is_multiple_of(2) && di == 1) || (at[1].is_multiple_of(2) && dj == 1) {
                        continue;
                    }
                    let node = [at[0] / 2 + di, at[1] / 2 + dj];
                    let here = [0, 1].map(|axis| node[axis].wrapping_sub(coarser.first[axis]));
                    if here[0] < coarser.size[0] && here[1] < coarser.size[1] {
                        let height = coarser.heights[here[1] * coarser.size[0] + here[0]];
                        if height.is_finite() {
                            sum += height;
                            count += 1.0;
                        }
                    }
                }
                self.heights[j * self.size[0] + i] = sum / count;
            }
        }
    }

    /// Into the bounds; a node without a height takes their centre, one without bounds is missing.
    pub fn hold(&mut self, bounds: &[[f32; 2]]) {
        for (height, &[low, high]) in self.heights.iter_mut().zip(bounds) {
            *height = match height.is_finite() && low.is_finite() {
                true => height.max(low).min(high),
                false => 0.5 * (low + high),
            };
        }
    }

    /// True for nodes whose stored height differs from a neighbour's by more than `limit_m`.
    pub fn steep(&self, window: &Window, limit_m: f32) -> Vec<bool> {
        let stride = 1_usize << self.level;
        let [width, height] = window.size;
        self.pixels()
            .map(|pixel| {
                let (column, row) = (pixel % width, pixel / width);
                let apart = |inside: bool, neighbour: usize| {
                    inside && (window.heights[neighbour] - window.heights[pixel]).abs() > limit_m
                };
                apart(column >= stride, pixel.wrapping_sub(stride))
                    || apart(column + stride < width, pixel + stride)
                    || apart(row >= stride, pixel.wrapping_sub(stride * width))
                    || apart(row + stride < height, pixel + stride * width)
            })
            .collect()
    }

    /// Every node that is not steep towards the mean of its neighbours; of a pair with one missing neither counts, so that a slope stays.
    pub fn sweep(&mut self, steep: &[bool]) {
        let [width, height] = self.size;
        let before = self.heights.clone();
        for j in 0..height {
            for i in 0..width {
                let k = j * width + i;
                let (mut sum, mut count) = (0.0, 0.0);
                if i > 0 && i + 1 < width {
                    let pair = before[k - 1] + before[k + 1];
                    if pair.is_finite() {
                        sum += pair;
                        count += 2.0;
                    }
                }
                if j > 0 && j + 1 < height {
                    let pair = before[k - width] + before[k + width];
                    if pair.is_finite() {
                        sum += pair;
                        count += 2.0;
                    }
                }
                if count > 0.0 && !steep[k] {
                    self.heights[k] += RELAXATION * (sum / count - before[k]);
                }
            }
        }
    }
}
