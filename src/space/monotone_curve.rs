//! A number that follows keyed values without going beyond them: a monotone cubic (Fritsch & Carlson 1980, with the slopes of Fritsch
//! & Butland 1984).

/// Cubics between points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MonotoneCurve {
    /// Abscissa, value, slope.
    points: Vec<[f64; 3]>,
}

impl MonotoneCurve {
    /// Through points (abscissa, value) whose abscissae increase; those that do not are left out.
    pub fn new(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut through: Vec<[f64; 3]> = Vec::new();
        for [x, y] in points {
            if through.last().is_none_or(|last| x > last[0]) {
                through.push([x, y, 0.0]);
            }
        }
        let secant = |k: usize| (through[k + 1][1] - through[k][1]) / (through[k + 1][0] - through[k][0]);
        let last = through.len().saturating_sub(1);
        let slopes: Vec<f64> = (0..through.len())
            .map(|k| match k {
                _ if last == 0 => 0.0,
                0 => secant(0),
                k if k == last => secant(k - 1),
                k => {
                    let [before, after] = [secant(k - 1), secant(k)];
                    let [h, next] = [
                        through[k][0] - through[k - 1][0],
                        through[k + 1][0] - through[k][0],
                    ];
                    // A harmonic mean; nothing at a turning point.
                    if before * after <= 0.0 {
                        return 0.0;
                    }
                    let [first, second] = [2.0 * next + h, next + 2.0 * h];
                    (first + second) / (first / before + second / after)
                }
            })
            .collect();
        for (point, slope) in through.iter_mut().zip(slopes) {
            point[2] = slope;
        }
        Self { points: through }
    }

    /// The value at an abscissa; that of the nearest end outside, none without points.
    pub fn at(&self, x: f64) -> Option<f64> {
        let [first, .., last] = self.points.as_slice() else {
            return self.points.first().map(|point| point[1]);
        };
        if x <= first[0] {
            return Some(first[1]);
        }
        if x >= last[0] {
            return Some(last[1]);
        }
        let k = self.points.partition_point(|point| point[0] <= x) - 1;
        let [[x0, y0, m0], [x1, y1, m1]] = [self.points[k], self.points[k + 1]];
        let (h, s) = (x1 - x0, (x - x0) / (x1 - x0));
        let (s2, s3) = (s * s, s * s * s);
        Some(
            (2.0 * s3 - 3.0 * s2 + 1.0) * y0
                + (s3 - 2.0 * s2 + s) * h * m0
                + (3.0 * s2 - 2.0 * s3) * y1
                + (s3 - s2) * h * m1,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_meets_its_points_and_never_turns_between_them() {
        let points = [
            [0.0, 1.0],
            [1.0, 1.0],
            [1.5, 4.0],
            [4.0, 4.5],
            [5.0, 9.0],
            [9.0, 9.0],
        ];
        let curve = MonotoneCurve::new(points);
        for [x, y] in points {
            assert!(curve.at(x).is_some_and(|value| (value - y).abs() < 1e-12), "{x}");
        }
        let values: Vec<f64> = (0..=900).filter_map(|k| curve.at(f64::from(k) * 0.01)).collect();
        assert_eq!(values.len(), 901);
        assert!(values.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12));
        // No jump in slope: second differences stay small.
        let bend = values
            .windows(3)
            .map(|three| (three[2] - 2.0 * three[1] + three[0]).abs());
        assert!(bend.fold(0.0, f64::max) < 0.01);
    }

    #[test]
    fn two_points_are_a_line_and_one_a_constant() {
        let line = MonotoneCurve::new([[2.0, 10.0], [4.0, 20.0]]);
        assert_eq!(line.at(2.5), Some(12.5));
        assert_eq!(line.at(7.0), Some(20.0));
        assert_eq!(MonotoneCurve::new([[1.0, 3.0]]).at(5.0), Some(3.0));
        assert_eq!(MonotoneCurve::new([]).at(5.0), None);
    }
}
