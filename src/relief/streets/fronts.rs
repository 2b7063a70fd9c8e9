//! How far the houses' fronts are on both sides of ways in one direction: for a row of places at once, as sums along digital lines.

use super::opening::Raster;

/// Free cells count up to here; a front counts e-fold less by so many metres.
const FRONT_M: f64 = 30.0;
const NEARER_M: f64 = 4.5;
/// Metres over which fronts are taken twice, one after the other: a place's own count most, those almost this far away some. Along the
/// axis that a way runs more along; a power of two in cells, at most 16, so that sums fit.
const ALONG_M: f64 = 32.0;

/// What a level tells of fronts along both axes.
pub struct Fronts {
    side: usize,
    cell_m: f64,
    /// Along x, then y: how near the front ahead is, 0 on buildings and where there is none; then behind.
    nearness: [[Vec<u8>; 2]; 2],
    /// 255 on free cells.
    free: Vec<u8>,
}

impl Fronts {
    /// Of cells that buildings cover.
    pub fn new(covered: &Raster, cell_m: f64) -> Self {
        let limit = (FRONT_M / cell_m).ceil() as u8;
        let near = |run: u8| (255.0 * (-(f64::from(run) - 0.5) * cell_m / NEARER_M).exp()).round() as u8;
        let table: Vec<u8> = (0..=limit)
            .map(|run| if run == 0 || run == limit { 0 } else { near(run) })
            .collect();
        let nearness = |step: [i64; 2]| {
            let runs = free_runs(covered, limit, step);
            runs.iter().map(|&run| table[usize::from(run)]).collect()
        };
        Self {
            side: covered.side,
            cell_m,
            nearness: [[1, 0], [0, 1]].map(|[dx, dy]| [nearness([dx, dy]), nearness([-dx, -dy])]),
            free: covered
                .values
                .iter()
                .map(|&value| 255 * u8::from(value == 0))
                .collect(),
        }
    }

    /// Cells of a line that is summed.
    fn cells(&self) -> usize {
        (ALONG_M / self.cell_m) as usize
    }

    /// Cells from a place to the farthest that counts.
    pub fn reach(&self) -> usize {
        self.cells() + 1
    }
}

/// Free cells from each cell towards `step`, a cell along one axis, itself counted; 0 on a covered one.
fn free_runs(covered: &Raster, limit: u8, [dx, dy]: [i64; 2]) -> Vec<u8> {
    let side = covered.side as i64;
    let mut runs = vec![limit; covered.values.len()];
    let onwards = |k: i64, step: i64| if step > 0 { side - 1 - k } else { k };
    for y in (0..side).map(|k| onwards(k, dy)) {
        for x in (0..side).map(|k| onwards(k, dx)) {
            let place = (y * side + x) as usize;
            let is_inside = (0..side).contains(&(x + dx)) && (0..side).contains(&(y + dy));
            let next = if is_inside {
                runs[((y + dy) * side + x + dx) as usize]
            } else {
                limit
            };
            let is_free = covered.values[place] == 0;
            runs[place] = if is_free {
                limit.min(next.saturating_add(1))
            } else {
                0
            };
        }
    }
    runs
}

/// Sums along ways of one direction for some rows of a level.
pub struct FrontSums {
    side: usize,
    /// The first row that the sums have, and cells from a place to that of its sum.
    first_row: usize,
    to_sum: isize,
    /// Metres across the way by which a front is nearer that counts e-fold; for a cell along the axis that it is looked for along.
    fold_m: f32,
    cell_m: f32,
    /// From a cell to the next along that axis.
    pub across: isize,
    /// Of nearness ahead, behind, and of free cells.
    sums: [Vec<u16>; 3],
}

impl FrontSums {
    /// Of the rows `from..to`, which lie at least [`Fronts::reach`] and one more from the raster's border; `angle`: of the ways, from x to y,
    /// less than half a turn.
    pub fn new(fronts: &Fronts, (from, to): (usize, usize), angle: f64) -> Self {
        let side = fronts.side;
        let (sine, cosine) = angle.sin_cos();
        let major = sine.abs().max(cosine.abs());
        let ahead = [cosine / major, sine / major];
        let cells = fronts.cells();
        let (first, end) = (from - fronts.reach(), to + fronts.reach());
        // Fronts are looked for along the axis that the way runs less along.
        let is_along_x = cosine.abs() >= sine.abs();
        let [near_ahead, near_behind] = &fronts.nearness[usize::from(is_along_x)];
        let sums = [near_ahead, near_behind, &fronts.free].map(|values| {
            let rows = &values[first * side..end * side];
            let mut sums: Vec<u16> = rows.iter().map(|&value| u16::from(value)).collect();
            sum_along(&mut sums, side, cells, ahead);
            sum_along(&mut sums, side, cells, ahead);
            sums
        });
        // Both sums begin at a place and lead ahead: half of each lies before the middle of both.
        let to_sum = -steps(cells, ahead)
            .map(|[dx, dy]| dy * side as isize + dx)
            .sum::<isize>();
        Self {
            side,
            first_row: first,
            to_sum,
            fold_m: (NEARER_M * major) as f32,
            cell_m: (fronts.cell_m * major) as f32,
            across: if is_along_x { side as isize } else { 1 },
            sums,
        }
    }

    /// Metres from a place to the fronts ahead and behind.
    pub fn at(&self, place: usize) -> [f32; 2] {
        let own = (place - self.first_row * self.side).wrapping_add_signed(self.to_sum);
        let [ahead, behind, free] = [0, 1, 2].map(|k| self.sums[k].get(own).copied().map_or(0.0, f32::from));
        let metres = |near: f32| -self.fold_m * (near / free.max(1.0) + 1.0e-4).ln();
        [metres(ahead), metres(behind)]
    }

    /// The nearest number of cells to metres across the way.
    pub fn cells_across(&self, metres: f32) -> isize {
        // A cast rounds down what is above 0.
        const BELOW: isize = 64;
        (metres / self.cell_m + BELOW as f32 + 0.5) as isize - BELOW
    }
}

/// Of each cell and those ahead, a power of two in all, the sum; beyond the rows there are none.
fn sum_along(values: &mut [u16], side: usize, cells: usize, ahead: [f64; 2]) {
    for [dx, dy] in steps(cells, ahead) {
        add_shifted(values, side, dx, dy as usize);
    }
}

/// Columns and rows from what is summed already to what is added, by doubling.
fn steps(cells: usize, ahead: [f64; 2]) -> impl Iterator<Item = [isize; 2]> {
    let doubled =
        std::iter::successors(Some(1), |summed| Some(2 * summed)).take_while(move |summed| *summed < cells);
    doubled.map(move |summed| ahead.map(|step| (step * summed as f64).round() as isize))
}

/// To each cell the one `dx` columns and `dy` rows on, which is not changed before.
fn add_shifted(values: &mut [u16], side: usize, dx: isize, dy: usize) {
    let rows = values.len() / side;
    let (from, to) = ((-dx).max(0) as usize, (side as isize - dx.max(0)).max(0) as usize);
    if from >= to {
        return;
    }
    let shifted = from.wrapping_add_signed(dx)..to.wrapping_add_signed(dx);
    for y in 0..rows.saturating_sub(dy) {
        let (before, other) = values.split_at_mut((y + dy) * side);
        if dy == 0 {
            let unchanged = other[shifted.clone()].to_vec();
            add(&mut other[from..to], &unchanged);
        } else {
            add(&mut before[y * side..][from..to], &other[shifted.clone()]);
        }
    }
}

/// Apart, so that the compiler knows that the two do not overlap.
#[inline(never)]
fn add(row: &mut [u16], other: &[u16]) {
    for (value, other) in row.iter_mut().zip(other) {
        *value += other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fronts_on_both_sides_of_a_corridor_are_where_they_are() {
        let side = 128;
        for angle in [0.0, 0.2, 0.7, 1.2, 2.0, 2.9] {
            let (sine, cosine) = f64::sin_cos(angle);
            // 10 m on one side of a line through the middle, 6 m on the other.
            let aside = |x: usize, y: usize| {
                2.0 * (cosine * (y as f64 - 64.0) - sine * (x as f64 - 64.0)) * f64::signum(cosine + 1.0e-9)
            };
            let covered = |k: usize| u8::from(!(-6.0..10.0).contains(&aside(k % side, k / side)));
            let values = (0..side * side).map(covered).collect();
            let fronts = Fronts::new(&Raster { side, values }, 2.0);
            let sums = FrontSums::new(&fronts, (60, 69), angle);
            let [ahead, behind] = sums.at(64 * side + 64);
            let is_flipped = cosine.abs() < sine.abs();
            let [left, right] = if is_flipped {
                [behind, ahead]
            } else {
                [ahead, behind]
            };
            let [left, right] = if is_flipped && cosine < 0.0 {
                [right, left]
            } else {
                [left, right]
            };
            assert!(
                (left - 10.0).abs() < 1.8 && (right - 6.0).abs() < 1.8,
                "{angle}: {left} {right}"
            );
        }
    }
}
