//! Mip levels of a orthophoto tile.

/// The orthophoto and its halvings down to one pixel, RGBA; each pixel the mean of the covered ones below
/// (in sRGB values: the difference from linear averaging is below what a orthophoto's own gamma leaves uncertain).
pub fn imagery_mips(rgba: Vec<u8>, side: usize) -> Vec<Vec<u8>> {
    let mut levels = vec![rgba];
    let mut side = side;
    while side > 1 {
        let half = side / 2;
        let below = &levels[levels.len() - 1];
        let mut level = Vec::with_capacity(4 * half * half);
        for row in 0..half {
            for column in 0..half {
                let mut sums = [0_u32; 4];
                for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let at = 4 * ((2 * row + dj) * side + 2 * column + di);
                    let alpha = u32::from(below[at + 3]);
                    for channel in 0..3 {
                        sums[channel] += alpha * u32::from(below[at + channel]);
                    }
                    sums[3] += alpha;
                }
                let weight = sums[3].max(1);
                level.extend([0, 1, 2].map(|channel| ((sums[channel] + weight / 2) / weight) as u8));
                level.push((sums[3] / 4) as u8);
            }
        }
        levels.push(level);
        side = half;
    }
    levels
}
