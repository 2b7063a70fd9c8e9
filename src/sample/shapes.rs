//! Convex polygons: splitting, setting back, area. Points run counter-clockwise.

use glam::DVec2;

/// A convex polygon, or any simple outline where only `area` and `centre` are used.
pub type Ring = Vec<DVec2>;

/// Area, square metres.
pub fn area(ring: &[DVec2]) -> f64 {
    0.5 * edges(ring).map(|(a, b)| a.perp_dot(b)).sum::<f64>()
}

/// Mean of the corners.
pub fn centre(ring: &[DVec2]) -> DVec2 {
    ring.iter().copied().sum::<DVec2>() / ring.len().max(1) as f64
}

/// Edges from corner to corner.
pub fn edges(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
}

/// The part of a convex polygon to the left of a line through `point` along `direction`.
pub fn left_of(ring: &[DVec2], point: DVec2, direction: DVec2) -> Ring {
    let side = |p: DVec2| direction.perp_dot(p - point);
    let mut kept = Ring::new();
    for (a, b) in edges(ring) {
        let (sa, sb) = (side(a), side(b));
        if sa >= 0.0 {
            kept.push(a);
        }
        if (sa > 0.0 && sb < 0.0) || (sa < 0.0 && sb > 0.0) {
            kept.push(a + (b - a) * (sa / (sa - sb)));
        }
    }
    kept
}

/// The direction of the longest edge.
pub fn longest_direction(ring: &[DVec2]) -> DVec2 {
    let longest = edges(ring)
        .map(|(a, b)| b - a)
        .max_by(|a, b| a.length().total_cmp(&b.length()));
    longest.unwrap_or(DVec2::X).normalize_or(DVec2::X)
}

/// Corners closer than `least` to the one before are left out.
pub fn without_short_edges(ring: &[DVec2], least: f64) -> Ring {
    let mut kept = Ring::new();
    for &point in ring {
        if kept.last().is_none_or(|last| last.distance(point) > least) {
            kept.push(point);
        }
    }
    while kept.len() > 3 && kept[0].distance(kept[kept.len() - 1]) <= least {
        kept.pop();
    }
    kept
}

/// Every edge moved inwards by `depth`, corner for corner; none when the polygon is too narrow.
pub fn set_back(ring: &[DVec2], depth: f64) -> Option<Ring> {
    let count = ring.len();
    let moved = |k: usize| {
        let (a, b) = (ring[k % count], ring[(k + 1) % count]);
        let direction = (b - a).normalize_or_zero();
        (a + direction.perp() * depth, direction)
    };
    let inner: Option<Ring> = (0..count)
        .map(|k| {
            let ((p, d), (q, e)) = (moved(k + count - 1), moved(k));
            let turn = d.perp_dot(e);
            (turn > 0.02).then(|| p + d * ((q - p).perp_dot(e) / turn))
        })
        .collect();
    inner.filter(|inner| {
        edges(inner)
            .zip(edges(ring))
            .all(|((a, b), (c, d))| (b - a).dot(d - c) > 0.0)
    })
}

/// A rectangle by its centre, its long direction and its sides.
pub fn rectangle(centre: DVec2, direction: DVec2, length: f64, width: f64) -> Ring {
    let (u, v) = (direction * (0.5 * length), direction.perp() * (0.5 * width));
    vec![centre - u - v, centre + u - v, centre + u + v, centre - u + v]
}

/// A regular polygon.
pub fn round(centre: DVec2, radius: f64, corners: usize) -> Ring {
    (0..corners)
        .map(|k| centre + DVec2::from_angle(k as f64 / corners as f64 * std::f64::consts::TAU) * radius)
        .collect()
}
