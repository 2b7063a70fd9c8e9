//! The facade coordinate of an outline: bays along a ring, a whole number from corner to corner, so that a facade has whole windows
//! only. It runs on round the ring and closes without a seam: the ring has a whole number of bays too. Coordinate `d` of KR 10-0738500,
//! in bays instead of metres.

use geo::LineString;

/// Cosine of the angle by which an outline turns at a corner, 25 degrees; where it turns less, a wall runs on, as round a tower.
const CORNER_COSINE: f64 = 0.906;

/// Bays from a wall run's corner to each vertex of a closed ring, the last one (the first again) included; `bay_m`: the width that a
/// bay comes near to, metres.
pub fn facade_coordinates(ring: &LineString<f64>, bay_m: f64) -> Vec<f64> {
    let lengths: Vec<f64> = ring.lines().map(|edge| edge.dx().hypot(edge.dy())).collect();
    let edges: Vec<_> = ring.lines().collect();
    let count = edges.len();
    if count == 0 {
        return vec![0.0; ring.0.len()];
    }
    let is_corner = |vertex: usize| {
        // Edges without length have no direction.
        let has_length = |edge: &usize| lengths[*edge] > 0.0;
        let before = (1..=count)
            .map(|back| (vertex + count - back) % count)
            .find(has_length);
        let after = (0..count).map(|on| (vertex + on) % count).find(has_length);
        let (Some(before), Some(after)) = (before, after) else {
            return false;
        };
        let dot = edges[before].dx() * edges[after].dx() + edges[before].dy() * edges[after].dy();
        dot < CORNER_COSINE * lengths[before] * lengths[after]
    };
    // Without a corner the ring is one run from its first vertex.
    let first = (0..count).find(|&vertex| is_corner(vertex)).unwrap_or(0);
    // Bays of every edge, run after run.
    let mut bays = vec![0.0; count];
    let mut start = 0;
    for step in 1..=count {
        if step < count && !is_corner(first + step) {
            continue;
        }
        let run = |step: usize| (first + step) % count;
        let length: f64 = (start..step).map(|step| lengths[run(step)]).sum();
        let whole = (length / bay_m).round().max(1.0);
        for step in start..step {
            bays[run(step)] = whole * lengths[run(step)] / length.max(f64::MIN_POSITIVE);
        }
        start = step;
    }
    // From the corner before the first vertex, so that corners are whole numbers.
    let last_corner = (0..count).rev().find(|&vertex| is_corner(vertex)).unwrap_or(0);
    let mut along = match is_corner(0) {
        true => 0.0,
        false if last_corner == 0 => 0.0,
        false => bays[last_corner..].iter().sum(),
    };
    let mut coordinates = vec![along];
    for edge in &bays {
        along += edge;
        coordinates.push(along);
    }
    coordinates
}

#[cfg(test)]
mod tests {
    use super::*;
    use geo::Coord;

    fn ring(points: &[[f64; 2]]) -> LineString<f64> {
        let closed = points.iter().chain(points.first());
        closed.map(|&[x, y]| Coord { x, y }).collect()
    }

    fn rotated(points: &[[f64; 2]], degrees: f64) -> Vec<[f64; 2]> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        points
            .iter()
            .map(|[x, y]| [x * cos - y * sin + 500.0, x * sin + y * cos - 300.0])
            .collect()
    }

    /// An L: at every corner a whole number, whatever its rotation and whichever vertex comes first.
    #[test]
    fn corners_are_whole_bays() {
        let l = [
            [0.0, 0.0],
            [20.3, 0.0],
            [20.3, 8.0],
            [9.1, 8.0],
            [9.1, 16.4],
            [0.0, 16.4],
        ];
        for degrees in [0.0, 17.0, 45.0, 133.0] {
            for first in 0..l.len() {
                let mut points = rotated(&l, degrees);
                points.rotate_left(first);
                let bays = facade_coordinates(&ring(&points), 3.0);
                assert!(
                    bays.iter().all(|bay| (bay - bay.round()).abs() < 1e-9),
                    "{bays:?}"
                );
                let widths = bays.windows(2).map(|bay| bay[1] - bay[0]);
                let mut whole: Vec<f64> = widths.map(f64::round).collect();
                whole.rotate_right(first);
                assert_eq!(whole, [7.0, 3.0, 4.0, 3.0, 3.0, 5.0]);
            }
        }
    }

    /// A vertex within a wall changes nothing, also where the ring begins there.
    #[test]
    fn a_wall_runs_on_through_a_vertex() {
        let points = [[4.0, 0.0], [12.0, 0.0], [12.0, 9.0], [0.0, 9.0], [0.0, 0.0]];
        let bays = facade_coordinates(&ring(&points), 3.0);
        let expected = [4.0 / 3.0, 4.0, 7.0, 11.0, 14.0, 14.0 + 4.0 / 3.0];
        assert!(
            bays.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9),
            "{bays:?}"
        );
    }

    /// A round tower has a whole number of equal bays.
    #[test]
    fn a_round_ring_closes() {
        let points: Vec<[f64; 2]> = (0..36)
            .map(|k| f64::from(k) * std::f64::consts::TAU / 36.0)
            .map(|angle| [8.0 * angle.cos(), 8.0 * angle.sin()])
            .collect();
        let bays = facade_coordinates(&ring(&points), 3.0);
        assert!(
            (bays[0], bays[36]) == (0.0, 17.0) || (bays[36] - 17.0).abs() < 1e-9,
            "{bays:?}"
        );
        let steps = bays.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(steps.into_iter().all(|step| (step - 17.0 / 36.0).abs() < 1e-9));
    }
}
