//! How the ghosts of a disc of light differ from those of a point: each point of the disc gives nearly the same ghost at another
//! place, so that every point of the disc's ghost is a disc.
//!
//! A ghost is an image of the iris, and moves as the rays through a point of the iris do; where the front of the lens bounds it, as
//! those through a point of the entrance. Where it is folded its bright edge is no image of either, and moves as the latter too.
//! Seen from a point of the sensor, the disc is one in the stop and one on the entrance: there iris and front are softened.

use glam::{DMat2, DVec2, DVec3};

use super::linear::LinearGhost;
use super::vertex::FlareSource;
use crate::camera::path::Ghost;
use crate::camera::trace::{TracedRay, Tracer, beam_direction};

/// Half the change of direction by which rays are told apart, radians.
const STEP: f64 = 1e-4;
/// The same of the entrance, millimetres.
const STEP_MM: f64 = 0.01;

/// Radii of the disc that the light's disc makes of a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Softness {
    /// Of the ghost's edge, on the sensor, millimetres.
    pub edge_mm: f64,
    /// Of its folds, on the sensor, millimetres.
    pub fold_mm: f64,
    /// In the stop, in radii of the iris.
    pub stop: f64,
    /// On the entrance, in radii of the front.
    pub front: f64,
}

impl Softness {
    /// By the matrices: d(tan a) / da is 1 / cos² a in the beam's plane and 1 / cos a across it; of the two the geometric mean.
    pub fn linear(linear: &LinearGhost, source: &FlareSource) -> Self {
        let ([a0, a1], [f0, f1]) = (linear.a, linear.f);
        let slope = source.angular_radius * source.angle.cos().powf(-1.5);
        let iris_mm = (f1 - f0 * a1 / a0).abs() * slope;
        let fold_mm = f1.abs() * slope;
        Self {
            edge_mm: if linear.is_front_bound() { fold_mm } else { iris_mm },
            fold_mm,
            stop: (a1 - a0 * f1 / f0).abs() * slope / linear.stop_mm,
            front: (f1 / f0).abs() * slope / linear.barrel_mm,
        }
    }

    /// By rays round a point of the entrance, millimetres; none where one of them gets lost.
    pub fn traced(
        tracer: &Tracer<'_>,
        ghost: Ghost,
        linear: &LinearGhost,
        entry_mm: DVec2,
        source: &FlareSource,
    ) -> Option<Self> {
        let ray = |entry: DVec2, direction: DVec3| tracer.trace(Some(ghost), entry, direction);
        let change = |from: Option<TracedRay>, to: Option<TracedRay>, distance: f64| {
            let (from, to) = (from?, to?);
            let per = |from: DVec2, to: DVec2| (to - from) / (2.0 * distance);
            Some([per(from.sensor_mm, to.sensor_mm), per(from.stop_mm, to.stop_mm)])
        };
        let along = |step: f64| beam_direction(source.angle + step);
        let across = |step: f64| beam_direction(source.angle) * step.cos() + DVec3::Y * step.sin();
        let centre = |direction| ray(entry_mm, direction);
        let [sensor_a, stop_a] = change(centre(along(-STEP)), centre(along(STEP)), STEP)?;
        let [sensor_b, stop_b] = change(centre(across(-STEP)), centre(across(STEP)), STEP)?;
        let beside = |axis: DVec2| {
            let [from, to] = [-STEP_MM, STEP_MM].map(|step| ray(entry_mm + step * axis, along(0.0)));
            change(from, to, STEP_MM)
        };
        let ([sensor_x, stop_x], [sensor_y, stop_y]) = (beside(DVec2::X)?, beside(DVec2::Y)?);
        // By the direction, by the entrance.
        let [sensor_d, stop_d] =
            [[sensor_a, sensor_b], [stop_a, stop_b]].map(|[a, b]| DMat2::from_cols(a, b));
        let [sensor_e, stop_e] =
            [[sensor_x, sensor_y], [stop_x, stop_y]].map(|[x, y]| DMat2::from_cols(x, y));
        let radius = |by_direction: DMat2| {
            let both = by_direction.x_axis.length() * by_direction.y_axis.length();
            source.angular_radius * both.sqrt()
        };
        let entry_d = sensor_e.inverse() * sensor_d;
        let fold_mm = radius(sensor_d);
        let softness = Self {
            edge_mm: if linear.is_front_bound() {
                fold_mm
            } else {
                radius(sensor_d - sensor_e * stop_e.inverse() * stop_d)
            },
            fold_mm,
            stop: radius(stop_d - stop_e * entry_d) / linear.stop_mm,
            front: radius(entry_d) / linear.barrel_mm,
        };
        softness.edge_mm.is_finite().then_some(softness)
    }
}
