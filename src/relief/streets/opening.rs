//! Grey-scale morphology on a square raster of bytes: openings by line segments (Soille & Talbot 2001, "Directional morphological
//! filtering", IEEE PAMI 23(11), section 2), and means of squares.

use rayon::prelude::*;

/// A square raster, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Cells along a side.
    pub side: usize,
    /// Values.
    pub values: Vec<u8>,
}

/// What openings by segments of one length leave.
pub struct Opened {
    /// By the number of its direction, from along x on: the largest value that a segment through the cell stays at or above.
    pub by_direction: Vec<(u32, Vec<u8>)>,
    /// The highest of them.
    pub highest: Vec<u8>,
    /// Their sum.
    pub sum: Vec<u16>,
}

impl Raster {
    /// Opened by segments of `length` cells in every `step`th of `directions` directions.
    pub fn opened_by_lines(&self, length: f64, directions: u32, step: u32) -> Opened {
        let opened = |scratch: &mut Scratch, direction: u32| {
            let angle = std::f64::consts::PI * f64::from(direction) / f64::from(directions);
            self.opened_by_line((length, angle), scratch);
            (direction, scratch.now.values.clone())
        };
        let by_direction: Vec<(u32, Vec<u8>)> = (0..directions / step)
            .into_par_iter()
            .map(|number| number * step)
            .map_init(|| Scratch::from_raster(self), opened)
            .collect();
        let mut highest = vec![0; self.values.len()];
        let mut sum = vec![0; self.values.len()];
        for (_, values) in &by_direction {
            for ((highest, sum), &value) in highest.iter_mut().zip(&mut sum).zip(values) {
                *highest = value.max(*highest);
                *sum += u16::from(value);
            }
        }
        Opened {
            by_direction,
            highest,
            sum,
        }
    }

    /// Eroded, then dilated by a segment, whose cells lie on a digital line.
    fn opened_by_line(&self, (length, angle): (f64, f64), scratch: &mut Scratch) {
        let (sine, cosine) = angle.sin_cos();
        let major = sine.abs().max(cosine.abs());
        let cells = ((length * major).round() as i64).max(1);
        let ahead = [cosine / major, sine / major];
        scratch.now.values.copy_from_slice(&self.values);
        scratch.along(cells, ahead, u8::min);
        scratch.along(cells, ahead.map(|step| -step), u8::max);
    }

    /// Each cell with the one at an offset from it.
    fn with_shifted(&self, [dx, dy]: [i64; 2], op: impl Fn(u8, u8) -> u8, onto: &mut Self) {
        let side = self.side as i64;
        let (from, to) = ((-dx).clamp(0, side), (side - dx).clamp(0, side));
        for y in 0..side {
            let row = |y: i64| &self.values[(y * side) as usize..((y + 1) * side) as usize];
            let target = &mut onto.values[(y * side) as usize..((y + 1) * side) as usize];
            if !(0..side).contains(&(y + dy)) || from >= to {
                target.copy_from_slice(row(y));
                continue;
            }
            let own = row(y);
            let [first, end] = [from as usize, to as usize];
            target[..first].copy_from_slice(&own[..first]);
            target[end..].copy_from_slice(&own[end..]);
            let other = &row(y + dy)[(from + dx) as usize..(to + dx) as usize];
            let pairs = own[first..end].iter().zip(other);
            for (value, (own, other)) in target[first..end].iter_mut().zip(pairs) {
                *value = op(*own, *other);
            }
        }
    }

    /// The mean of the square of `radius` cells round each cell; the raster's border counts on beyond it.
    pub fn mean_within(&self, radius: usize) -> Self {
        let last = self.side - 1;
        let row = |k: usize| &self.values[k.saturating_sub(radius).min(last) * self.side..][..self.side];
        let part = 1.0 / ((2 * radius + 1) as f32).powi(2);
        let mut columns = vec![0_u32; self.side];
        for k in 0..2 * radius {
            add(&mut columns, row(k), |sum, value| sum + value);
        }
        let mut values = Vec::with_capacity(self.values.len());
        for y in 0..self.side {
            add(&mut columns, row(y + 2 * radius), |sum, value| sum + value);
            let at = |k: usize| columns[k.saturating_sub(radius).min(last)];
            let mut sum: u32 = (0..2 * radius).map(at).sum();
            values.extend((0..self.side).map(|x| {
                sum += at(x + 2 * radius);
                let mean = (sum as f32 * part + 0.5) as u8;
                sum -= at(x);
                mean
            }));
            add(&mut columns, row(y), |sum, value| sum - value);
        }
        Self {
            side: self.side,
            values,
        }
    }
}

fn add(sums: &mut [u32], row: &[u8], op: impl Fn(u32, u32) -> u32) {
    for (sum, &value) in sums.iter_mut().zip(row) {
        *sum = op(*sum, u32::from(value));
    }
}

/// A raster that is worked on, and room for what comes of it.
struct Scratch {
    now: Raster,
    next: Raster,
}

impl Scratch {
    fn from_raster(raster: &Raster) -> Self {
        Self {
            now: raster.clone(),
            next: raster.clone(),
        }
    }

    /// Of each cell and those after it, `cells` in all, what an operation leaves; beyond the raster there are none. By doubling.
    fn along(&mut self, cells: i64, step: [f64; 2], op: impl Fn(u8, u8) -> u8 + Copy) {
        let mut covered = 1;
        while covered < cells {
            let far = covered.min(cells - covered);
            let offset = step.map(|step| (step * far as f64).round() as i64);
            self.now.with_shifted(offset, op, &mut self.next);
            std::mem::swap(&mut self.now, &mut self.next);
            covered += far;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raster(side: usize, value: impl Fn(usize, usize) -> u8) -> Raster {
        let values = (0..side * side).map(|k| value(k % side, k / side)).collect();
        Raster { side, values }
    }

    fn opened_by_line(raster: &Raster, line: (f64, f64)) -> Raster {
        let mut scratch = Scratch::from_raster(raster);
        raster.opened_by_line(line, &mut scratch);
        scratch.now
    }

    #[test]
    fn a_long_corridor_stays_and_a_short_one_goes() {
        // Corridors along x, three cells wide: one through the raster, one of 12 cells.
        let open =
            |x: usize, y: usize| (9..12).contains(&y) || ((30..33).contains(&y) && (20..32).contains(&x));
        let opened = raster(48, |x, y| if open(x, y) { 80 } else { 5 }).opened_by_lines(20.0, 16, 1);
        let at = |x: usize, y: usize| opened.highest[y * 48 + x];
        assert!((0..48).all(|x| at(x, 10) == 80));
        assert!((20..32).all(|x| at(x, 31) == 5));
    }

    #[test]
    fn an_opening_never_lifts_and_is_itself_when_repeated_along_an_axis() {
        let noise = raster(40, |x, y| ((x * 7 + y * 13 + x * y) % 251) as u8);
        for angle in [0.0, 0.4, 1.2, 2.5] {
            let opened = opened_by_line(&noise, (9.0, angle));
            assert!(
                opened.values.iter().zip(&noise.values).all(|(a, b)| a <= b),
                "{angle}"
            );
        }
        let once = opened_by_line(&noise, (9.0, 0.0));
        assert_eq!(opened_by_line(&once, (9.0, 0.0)), once);
    }

    #[test]
    fn a_mean_is_of_a_square() {
        let point = raster(21, |x, y| if (x, y) == (10, 10) { 250 } else { 0 });
        for (k, mean) in point.mean_within(2).values.iter().enumerate() {
            let far = (k % 21).abs_diff(10).max((k / 21).abs_diff(10));
            assert_eq!(*mean, if far <= 2 { 10 } else { 0 }, "{k}");
        }
    }
}
