//! How far the nearest building is from the ground round it.

use super::opening::Raster;

/// Clearances count in tenths of a metre, to 25.5 m.
pub const CLEARANCE_STEP_M: f64 = 0.1;
/// The largest.
pub const MAX_CLEARANCE_M: f64 = 255.0 * CLEARANCE_STEP_M;

/// From the centre of each cell to the nearest covered one's side, by the squares of the ways along the axes (Meijster, Roerdink &
/// Hesselink 2000, "A General Algorithm for Computing Distance Transforms in Linear Time", section 2), as far as it counts.
pub fn clearances(covered: &Raster, cell_m: f64) -> Raster {
    let side = covered.side;
    let reach = (MAX_CLEARANCE_M / cell_m).ceil() as u16 + 1;
    // Cells up and down to the nearest.
    let mut away: Vec<u16> = covered
        .values
        .iter()
        .map(|&value| if value == 0 { reach } else { 0 })
        .collect();
    for y in 1..side {
        let (before, row) = away.split_at_mut(y * side);
        step_from(&before[(y - 1) * side..], &mut row[..side]);
    }
    for y in (1..side).rev() {
        let (before, row) = away.split_at_mut(y * side);
        step_from(&row[..side], &mut before[(y - 1) * side..]);
    }
    let clearance = |square: usize| {
        let metres = ((square as f64).sqrt() - 0.5).max(0.0) * cell_m;
        (metres / CLEARANCE_STEP_M).round().min(255.0) as u8
    };
    let table: Vec<u8> = (0..=usize::from(reach * reach)).map(clearance).collect();
    let mut values = Vec::with_capacity(side * side);
    for row in away.chunks_exact(side) {
        let mut least: Vec<u16> = row.iter().map(|&cells| cells * cells).collect();
        for aside in 1..usize::from(reach).min(side) {
            let square = (aside * aside) as u16;
            for (least, &cells) in least[aside..].iter_mut().zip(row) {
                *least = (*least).min(cells * cells + square);
            }
            for (least, &cells) in least.iter_mut().zip(&row[aside..]) {
                *least = (*least).min(cells * cells + square);
            }
        }
        values.extend(least.into_iter().map(|square| table[usize::from(square)]));
    }
    Raster { side, values }
}

/// A row is at most a cell farther than the one beside it.
fn step_from(beside: &[u16], row: &mut [u16]) {
    for (cells, &other) in row.iter_mut().zip(beside) {
        *cells = (*cells).min(other + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clearance_is_the_way_to_the_nearest_building() {
        let side = 64;
        let buildings = [[20, 31], [21, 31], [50, 8]];
        let mut values = vec![0; side * side];
        for [x, y] in buildings {
            values[y * side + x] = 1;
        }
        let clear = clearances(&Raster { side, values }, 2.0);
        for (k, &value) in clear.values.iter().enumerate() {
            let from = [(k % side) as f64, (k / side) as f64];
            let way = |at: &[usize; 2]| (from[0] - at[0] as f64).hypot(from[1] - at[1] as f64);
            let nearest = buildings.iter().map(way).fold(f64::INFINITY, f64::min);
            let metres = (2.0 * (nearest - 0.5)).clamp(0.0, 25.5);
            assert!(
                (f64::from(value) * CLEARANCE_STEP_M - metres).abs() <= 0.051,
                "{k}: {value} {metres}"
            );
        }
    }
}
