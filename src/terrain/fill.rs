//! Fills narrow holes in a lattice of heights.

/// Fills runs of missing samples that are bounded by known ones in their row or column and at most
/// `max_samples` long. The value is linear across the hole, rows and columns weighted by the inverse of the
/// run's length. Wider holes, and those open to the lattice's border, stay.
pub fn fill_gaps(heights: &mut [f32], size: [usize; 2], max_samples: usize) {
    if max_samples == 0 || heights.iter().all(|height| height.is_finite()) {
        return;
    }
    let mut sums = vec![[0.0_f64; 2]; heights.len()];
    let mut line = |start: usize, stride: usize, count: usize| {
        let mut last_known: Option<usize> = None;
        for index in 0..count {
            let here = heights[start + index * stride];
            if !here.is_finite() {
                continue;
            }
            if let Some(last) = last_known {
                let missing = index - last - 1;
                if missing > 0 && missing <= max_samples {
                    let before = f64::from(heights[start + last * stride]);
                    let weight = 1.0 / missing as f64;
                    for gap in last + 1..index {
                        let along = (gap - last) as f64 / (index - last) as f64;
                        let value = before + (f64::from(here) - before) * along;
                        let [sum, total] = &mut sums[start + gap * stride];
                        *sum += weight * value;
                        *total += weight;
                    }
                }
            }
            last_known = Some(index);
        }
    };
    for row in 0..size[1] {
        line(row * size[0], 1, size[0]);
    }
    for column in 0..size[0] {
        line(column, size[0], size[1]);
    }
    for (height, [sum, total]) in heights.iter_mut().zip(sums) {
        if !height.is_finite() && total > 0.0 {
            *height = (sum / total) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_holes_in_a_plane_are_filled_with_the_plane() {
        let size = [9, 9];
        let plane = |k: usize| (k % 9) as f32 * 2.0 + (k / 9) as f32;
        let mut heights: Vec<f32> = (0..81).map(plane).collect();
        for k in [40, 41, 31, 32] {
            heights[k] = f32::NAN;
        }
        fill_gaps(&mut heights, size, 2);
        for (k, height) in heights.iter().enumerate() {
            assert!((height - plane(k)).abs() < 1e-5, "sample {k}");
        }
    }

    #[test]
    fn wide_holes_and_open_borders_stay() {
        let mut heights = vec![1.0_f32; 49];
        for k in [0, 1, 7, 8, 16, 17, 18, 23, 24, 25, 30, 31, 32] {
            heights[k] = f32::NAN;
        }
        let before = heights.iter().filter(|h| h.is_nan()).count();
        fill_gaps(&mut heights, [7, 7], 1);
        assert_eq!(heights.iter().filter(|h| h.is_nan()).count(), before);
    }
}
