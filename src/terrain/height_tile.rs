//! Ground heights of one tile: `side` x `side` samples, the outermost on the tile's border, so that
//! neighbours share them.

/// Heights in metres, NaN where there is no ground; row by row from the south.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightTile {
    /// Samples along a side: intervals + 1.
    pub side: usize,
    /// Distance between samples, metres.
    pub step_m: f64,
    /// `side * side` heights.
    pub heights: Vec<f32>,
}

impl HeightTile {
    /// Ground at a point in metres from the tile's south-west corner: bilinear between samples, none where
    /// a sample that counts is missing or the point is outside.
    pub fn ground(&self, x: f64, y: f64) -> Option<f64> {
        let last = self.side - 1;
        let (u, v) = (x / self.step_m, y / self.step_m);
        let inside = |value: f64| (-1e-9..=last as f64 + 1e-9).contains(&value);
        if !inside(u) || !inside(v) {
            return None;
        }
        let (i, j) = (
            (u.max(0.0) as usize).min(last - 1),
            (v.max(0.0) as usize).min(last - 1),
        );
        let (fx, fy) = (u - i as f64, v - j as f64);
        let at = |di: usize, dj: usize, weight: f64| {
            if weight <= 1e-9 {
                return 0.0;
            }
            f64::from(self.heights[(j + dj) * self.side + i + di]) * weight
        };
        let height = at(0, 0, (1.0 - fx) * (1.0 - fy))
            + at(1, 0, fx * (1.0 - fy))
            + at(0, 1, (1.0 - fx) * fy)
            + at(1, 1, fx * fy);
        height.is_finite().then_some(height)
    }

    /// Lowest and highest sample, metres; none without ground.
    pub fn range(&self) -> Option<[f32; 2]> {
        let valid = self.heights.iter().copied().filter(|height| height.is_finite());
        valid.fold(None, |range: Option<[f32; 2]>, height| {
            Some(range.map_or([height; 2], |[low, high]| [low.min(height), high.max(height)]))
        })
    }
}
