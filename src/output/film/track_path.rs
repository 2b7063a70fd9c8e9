//! A flight along a recorded track: over its points, looking ahead.

use glam::{DVec2, DVec3};

use super::{FlightPath, PathKey};
use crate::source::TrackPoint;

/// Keys are so far apart at least, metres: a receiver's noise is no flight.
const SPACING_M: f64 = 40.0;
/// Height above the ground at least, and where the track says none, metres.
const CLEARANCE_M: f64 = 12.0;
const HEIGHT_M: f64 = 90.0;
/// Points ahead that the camera looks at: as far as it flies in so many keys; and how far below the eye, metres a metre.
const AHEAD: usize = 3;
const SLOPE: f64 = 0.28;
/// Speed of a track without times, metres a second.
const SPEED_M_S: f64 = 40.0;

impl FlightPath {
    /// Along a track. `ground`: metres at a point of the city, none where there is none.
    pub fn from_track(track: &[TrackPoint], ground: impl Fn(DVec2) -> Option<f64>) -> Self {
        let mut kept: Vec<TrackPoint> = Vec::new();
        for point in track {
            let is_far = |last: &TrackPoint| last.position.distance(point.position) >= SPACING_M;
            let is_later = |last: &TrackPoint| match (last.time_s, point.time_s) {
                (Some(before), Some(now)) => now > before,
                _ => true,
            };
            if kept.last().is_none_or(|last| is_far(last) && is_later(last)) {
                kept.push(*point);
            }
        }
        let has_times = kept.iter().all(|point| point.time_s.is_some());
        let first_s = kept.first().and_then(|point| point.time_s).unwrap_or(0.0);
        let eyes: Vec<DVec3> = kept
            .iter()
            .map(|point| {
                let ground = ground(point.position);
                let wished = point
                    .elevation_m
                    .or(ground.map(|ground| ground + HEIGHT_M))
                    .unwrap_or(HEIGHT_M);
                point
                    .position
                    .extend(wished.max(ground.map_or(f64::MIN, |ground| ground + CLEARANCE_M)))
            })
            .collect();
        let mut flown_s = 0.0;
        let keys = (0..eyes.len()).map(|k| {
            if k > 0 {
                flown_s += eyes[k].distance(eyes[k - 1]) / SPEED_M_S;
            }
            let ahead = eyes[(k + AHEAD).min(eyes.len() - 1)] - eyes[k];
            // At the end on as before.
            let before = eyes[k] - eyes[k.saturating_sub(AHEAD)];
            let level = if ahead.truncate().length() > 1.0 {
                ahead
            } else {
                before
            }
            .truncate();
            let direction = level.normalize_or(DVec2::Y).extend(-SLOPE);
            PathKey {
                t: Some(
                    kept[k]
                        .time_s
                        .filter(|_| has_times)
                        .map_or(flown_s, |time| time - first_s),
                ),
                eye: eyes[k].to_array(),
                look: (eyes[k] + 100.0 * direction).to_array(),
                ..PathKey::default()
            }
        });
        Self { keys: keys.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_is_flown_over_the_ground_looking_ahead() {
        let track: Vec<TrackPoint> = (0..200)
            .map(|k| TrackPoint {
                position: DVec2::new(1000.0 + 5.0 * f64::from(k), 2000.0),
                elevation_m: None,
                time_s: None,
            })
            .collect();
        let path = FlightPath::from_track(&track, |at| Some(100.0 + 0.1 * (at.x - 1000.0)));
        assert!((20..30).contains(&path.keys.len()), "{}", path.keys.len());
        for key in &path.keys {
            let ground = 100.0 + 0.1 * (key.eye[0] - 1000.0);
            assert!((key.eye[2] - ground - HEIGHT_M).abs() < 1e-9);
            assert!(key.look[0] > key.eye[0] && key.look[2] < key.eye[2], "{key:?}");
        }
        let times: Vec<f64> = path.times().collect();
        assert!(times.windows(2).all(|pair| pair[1] > pair[0]));
        // A kilometre at the stated speed, up a slope.
        assert!((times[times.len() - 1] - 995.0 * 1.01_f64.sqrt() / SPEED_M_S).abs() < 1.0);
    }
}
