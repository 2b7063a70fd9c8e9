//! A block of heights read from one raster, and its bilinear surface.

/// Heights of a rectangle of pixels, metres, NaN where there is none; row-major from the top.
pub struct Window {
    /// First column and row in the raster.
    pub first: [usize; 2],
    /// Columns and rows.
    pub size: [usize; 2],
    /// `size[0] * size[1]` heights.
    pub heights: Vec<f32>,
}

impl Window {
    /// Height at fractional pixel coordinates of the raster (0.5, 0.5 = centre of its first pixel):
    /// bilinear between the four pixel centres around it, NaN when one of those that count is missing. In the
    /// outermost half pixel, which the raster covers but no four centres surround, the nearest edge counts.
    pub fn bilinear(&self, column: f64, row: f64) -> f64 {
        let x = column - 0.5 - self.first[0] as f64;
        let y = row - 0.5 - self.first[1] as f64;
        let [width, height] = self.size;
        // A hair of tolerance: transformed points land a rounding error outside the raster.
        const SLACK: f64 = 1e-6;
        let inside =
            |value: f64, count: usize| value >= -0.5 - SLACK && value <= (count as f64 - 0.5) + SLACK;
        if width == 0 || height == 0 || !inside(x, width) || !inside(y, height) {
            return f64::NAN;
        }
        let (i, fx) = cell(x, width);
        let (j, fy) = cell(y, height);
        let at = |dx: usize, dy: usize, weight: f64| {
            if weight <= SLACK {
                return 0.0;
            }
            f64::from(self.heights[(j + dy) * width + i + dx]) * weight
        };
        at(0, 0, (1.0 - fx) * (1.0 - fy))
            + at(1, 0, fx * (1.0 - fy))
            + at(0, 1, (1.0 - fx) * fy)
            + at(1, 1, fx * fy)
    }
}

/// Index of the cell's lower sample and the fraction beyond it, kept inside the samples.
fn cell(value: f64, count: usize) -> (usize, f64) {
    let value = value.clamp(0.0, count as f64 - 1.0);
    let index = (value.floor() as usize).min(count.saturating_sub(2));
    (index, value - index as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bilinear_is_exact_at_centres_and_linear_between() {
        let window = Window {
            first: [10, 20],
            size: [2, 2],
            heights: vec![0.0, 1.0, 2.0, 7.0],
        };
        assert_eq!(window.bilinear(10.5, 20.5), 0.0);
        assert_eq!(window.bilinear(11.5, 21.5), 7.0);
        assert_eq!(window.bilinear(11.0, 21.0), 2.5);
        assert_eq!(window.bilinear(10.1, 20.5), 0.0);
        assert!(window.bilinear(9.9, 20.5).is_nan());
    }

    #[test]
    fn a_missing_neighbour_leaves_no_height_but_only_where_it_counts() {
        let window = Window {
            first: [0, 0],
            size: [2, 1],
            heights: vec![3.0, f32::NAN],
        };
        assert_eq!(window.bilinear(0.5, 0.5), 3.0);
        assert!(window.bilinear(0.6, 0.5).is_nan());
    }
}
