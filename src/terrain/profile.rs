//! Which samples of a tile's border become vertices.
//!
//! The choice depends on the border's own samples alone, so both tiles that share the border choose the same
//! and no crack can open (Douglas & Peucker 1973, on the height profile).

/// Indices to keep, ascending: ends of every run of known samples, and what the tolerance asks between.
pub fn profile_vertices(heights: &[f32], tolerance_m: f32) -> Vec<usize> {
    let mut kept = Vec::new();
    let mut start = 0;
    while start < heights.len() {
        if !heights[start].is_finite() {
            start += 1;
            continue;
        }
        let run = heights[start..]
            .iter()
            .take_while(|height| height.is_finite())
            .count();
        let end = start + run - 1;
        kept.push(start);
        split(heights, start, end, tolerance_m, &mut kept);
        if end > start {
            kept.push(end);
        }
        start = end + 1;
    }
    kept
}

fn split(heights: &[f32], start: usize, end: usize, tolerance_m: f32, kept: &mut Vec<usize>) {
    let (h0, h1) = (heights[start], heights[end]);
    let mut worst = (tolerance_m, None);
    for (index, height) in heights.iter().enumerate().take(end).skip(start + 1) {
        let along = (index - start) as f32 / (end - start) as f32;
        let error = (height - (h0 + (h1 - h0) * along)).abs();
        if error > worst.0 {
            worst = (error, Some(index));
        }
    }
    if let (_, Some(centre)) = worst {
        split(heights, start, centre, tolerance_m, kept);
        kept.push(centre);
        split(heights, centre, end, tolerance_m, kept);
    }
}
