//! The orthophoto of one tile, and its halvings: mip levels and the tiles of coarser levels.

/// Imagery of one tile.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageryTile {
    /// Pixels along a side.
    pub side: usize,
    /// RGBA, rows from the north; alpha 0 without orthophoto.
    pub rgba: Vec<u8>,
}

impl ImageryTile {
    /// With half as many pixels along a side, each the mean of the covered ones of four (in sRGB values: the difference from linear
    /// averaging is below what an orthophoto's own gamma leaves uncertain).
    pub fn halved(&self) -> Self {
        let (wide, side) = (self.side, self.side / 2);
        let mut rgba = Vec::with_capacity(4 * side * side);
        for row in 0..side {
            for column in 0..side {
                let mut sums = [0_u32; 4];
                for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let at = 4 * ((2 * row + dj) * wide + 2 * column + di);
                    let alpha = u32::from(self.rgba[at + 3]);
                    for (sum, &channel) in sums.iter_mut().zip(&self.rgba[at..at + 3]) {
                        *sum += alpha * u32::from(channel);
                    }
                    sums[3] += alpha;
                }
                let weight = sums[3];
                rgba.extend([0, 1, 2].map(|channel| match weight {
                    // Where nothing is covered the colour that lies under it goes on.
                    0 => self.rgba[4 * (2 * row * wide + 2 * column) + channel],
                    weight => ((sums[channel] + weight / 2) / weight) as u8,
                }));
                rgba.push((sums[3] / 4) as u8);
            }
        }
        Self { side, rgba }
    }

    /// The tile over four tiles of the level below (south-west, south-east, north-west, north-east); none without any.
    pub fn coarser(children: [Option<&Self>; 4]) -> Option<Self> {
        let side = children.iter().flatten().next()?.side;
        let half = side / 2;
        let mut rgba = vec![0; 4 * side * side];
        for (quadrant, child) in children.iter().enumerate() {
            let Some(child) = child else { continue };
            let small = child.halved();
            // Rows from the north: southern children below.
            let (column, row) = (half * (quadrant % 2), half * (1 - quadrant / 2));
            for (k, pixels) in small.rgba.chunks_exact(4 * half).enumerate() {
                let start = 4 * ((row + k) * side + column);
                rgba[start..start + 4 * half].copy_from_slice(pixels);
            }
        }
        Some(Self { side, rgba })
    }
}
