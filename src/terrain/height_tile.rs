//! Ground heights of one tile: `side` x `side` samples, the outermost on the tile's border, so that
//! neighbours share them. The surface between them is bilinear.

/// Heights in metres, NaN where there is no ground; row by row from the south.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightTile {
    /// Samples along a side: intervals + 1.
    pub side: usize,
    /// Level in the tile quadtree: how often the distance between samples is doubled.
    pub level: u32,
    /// Distance between samples, metres.
    pub step_m: f64,
    /// `side * side` heights.
    pub heights: Vec<f32>,
}

/// Distance between the positions that a mesh of level 0 may use, at most, metres; it doubles from level to level. Two triangles differ from the bilinear cell under
/// them by a quarter of its twist, which shrinks with the square of the distance: 90 m of steep ground differ by metres,
/// 4 m of the same ground by millimetres.
const MESH_STEP_M: f64 = 4.0;

/// Most mesh intervals along a tile's side.
const MAX_MESH_INTERVALS: usize = 1024;

impl HeightTile {
    /// Parts that the mesh divides a cell's side into. A mesh's vertices lie on the lattice so refined,
    /// `(side - 1) * mesh_parts + 1` positions a side, and have the bilinear surface's height.
    pub fn mesh_parts(&self) -> usize {
        let mesh_step_m = MESH_STEP_M * f64::from(1_u32 << self.level);
        let wanted = (self.step_m / mesh_step_m).ceil() as usize;
        wanted.min(MAX_MESH_INTERVALS / (self.side - 1).max(1)).max(1)
    }

    /// Mesh positions along a side.
    pub fn mesh_side(&self) -> usize {
        (self.side - 1) * self.mesh_parts() + 1
    }

    /// The same surface on a lattice `parts` times as fine; missing where a sample that counts is missing.
    pub fn refined(&self, parts: usize) -> Self {
        let side = (self.side - 1) * parts + 1;
        // Index of the cell's first sample, and the weight of its second.
        let split = |index: usize| {
            let first = (index / parts).min(self.side - 2);
            (first, (index - first * parts) as f32 / parts as f32)
        };
        let mix = |a: f32, b: f32, weight: f32| match weight {
            0.0 => a,
            1.0 => b,
            _ => a * (1.0 - weight) + b * weight,
        };
        let heights = (0..side * side)
            .map(|k| {
                let ((i, x), (j, y)) = (split(k % side), split(k / side));
                let row = |j: usize| {
                    mix(
                        self.heights[j * self.side + i],
                        self.heights[j * self.side + i + 1],
                        x,
                    )
                };
                mix(row(j), row(j + 1), y)
            })
            .collect();
        Self {
            side,
            level: self.level,
            step_m: self.step_m / parts as f64,
            heights,
        }
    }

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
