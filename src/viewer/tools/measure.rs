//! Lengths, heights and areas between points of the city.

use glam::DVec3;

/// Points measured, in the order of the clicks.
#[derive(Clone, Debug, Default)]
pub struct Measure {
    /// Points, metres in the city's CRS.
    pub points: Vec<DVec3>,
}

impl Measure {
    /// Length of the line through the points in plan and in space, metres.
    pub fn lengths(&self) -> [f64; 2] {
        let pairs = || self.points.windows(2).map(|pair| pair[1] - pair[0]);
        [
            pairs().map(|step| step.truncate().length()).sum(),
            pairs().map(DVec3::length).sum(),
        ]
    }

    /// Height of the last point over the first, metres.
    pub fn rise(&self) -> f64 {
        match self.points.as_slice() {
            [first, .., last] => last.z - first.z,
            _ => 0.0,
        }
    }

    /// Area in plan of the polygon through the points (Gauss's formula), square metres; none for fewer than three.
    pub fn area(&self) -> Option<f64> {
        let [first, _, _, ..] = self.points.as_slice() else {
            return None;
        };
        // From the first point, so that large coordinates do not take the digits.
        let relative: Vec<DVec3> = self.points.iter().map(|point| *point - *first).collect();
        let next = relative.iter().cycle().skip(1);
        let twice: f64 = relative
            .iter()
            .zip(next)
            .map(|(a, b)| a.x * b.y - b.x * a.y)
            .sum();
        Some(0.5 * twice.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_right_triangle_far_from_the_origin_has_its_figures() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(690_000.0 + x, 5_330_000.0 + y, z);
        let measure = Measure {
            points: vec![at(0.0, 0.0, 500.0), at(30.0, 0.0, 540.0), at(30.0, 40.0, 540.0)],
        };
        assert!((measure.lengths()[0] - 70.0).abs() < 1e-9);
        assert!((measure.lengths()[1] - 90.0).abs() < 1e-9);
        assert!((measure.rise() - 40.0).abs() < 1e-9);
        assert!(measure.area().is_some_and(|area| (area - 600.0).abs() < 1e-9));
        assert_eq!(Measure::default().area(), None);
    }
}
