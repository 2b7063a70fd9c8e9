//! The table of grids of rays, and its evaluation.
//!
//! Between angles, colours and rays the table is interpolated; the rotation round the axis is made at evaluation, as the lens is
//! symmetrical.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::knot::{COLOURS_UM, CURVE_UM, Knot, Light, Unpacked, VALUES, Values, stored};
use crate::camera::flare::ghost::grid::RayGrid;
use crate::camera::path::Ghost;
use crate::camera::trace::TracedRay;

/// The table of a lens at an f-number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlareTable {
    /// f-number it was baked for.
    pub f_number: f64,
    /// Largest angle, radians.
    pub max_angle: f64,
    pub(super) ghosts: Vec<TabledGhost>,
    /// Reflections of the ghosts that no grid tells well enough: they are to be traced.
    pub(super) traced: Vec<[usize; 2]>,
}

/// One ghost's grids by angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TabledGhost {
    pub(super) first: usize,
    pub(super) second: usize,
    pub(super) knots: Vec<Knot>,
}

/// A ghost at an angle.
#[derive(Clone, Debug)]
pub struct EvaluatedGhost {
    unpacked: Unpacked,
}

impl FlareTable {
    /// A ghost's grids; none for one that is linear enough.
    pub fn ghost(&self, ghost: Ghost) -> Option<&TabledGhost> {
        self.ghosts
            .iter()
            .find(|tabled| (tabled.first, tabled.second) == (ghost.first, ghost.second))
    }

    /// Whether a ghost is left to be traced.
    pub fn is_traced(&self, ghost: Ghost) -> bool {
        self.traced.contains(&[ghost.first, ghost.second])
    }

    /// Number of ghosts that are left to be traced.
    pub fn traced(&self) -> usize {
        self.traced.len()
    }

    /// Number of ghosts in it.
    pub fn len(&self) -> usize {
        self.ghosts.len()
    }

    /// Whether every ghost is linear enough.
    pub fn is_empty(&self) -> bool {
        self.ghosts.is_empty()
    }

    /// Number of knots, all ghosts together.
    pub fn knots(&self) -> usize {
        self.ghosts.iter().map(|ghost| ghost.knots.len()).sum()
    }

    /// Bytes of all grids.
    pub fn bytes(&self) -> usize {
        let knots = self.ghosts.iter().flat_map(|ghost| &ghost.knots);
        knots
            .map(|knot| 16 + knot.light.as_ref().map_or(0, |light| light.bytes()))
            .sum()
    }

    /// Whether all sizes and numbers are sound (a file may be damaged).
    pub(super) fn is_sound(&self) -> bool {
        let is_number = [self.f_number, self.max_angle]
            .iter()
            .all(|number| number.is_finite() && *number > 0.0);
        is_number
            && self.ghosts.iter().all(|ghost| {
                let ordered = ghost.knots.windows(2).all(|pair| pair[0].angle < pair[1].angle);
                let lights = ghost.knots.iter().flat_map(|knot| &knot.light);
                !ghost.knots.is_empty()
                    && ordered
                    && ghost
                        .knots
                        .iter()
                        .all(|knot| knot.angle.is_finite() && knot.nonlinearity_error.is_finite())
                    && lights.clone().all(|light| light.is_sound())
                    && lights
                        .clone()
                        .all(|light| Some(light.size()) == lights.clone().next().map(Light::size))
            })
    }
}

impl TabledGhost {
    /// Nonlinearity error at an angle, radians.
    pub fn nonlinearity_error(&self, angle: f64) -> f64 {
        let next = self.knots.iter().position(|knot| knot.angle >= angle);
        let Some(next) = next else {
            return f64::INFINITY;
        };
        let upper = &self.knots[next];
        let lower = &self.knots[next.saturating_sub(1)];
        let fraction = (angle - lower.angle) / (upper.angle - lower.angle).max(1e-12);
        let (from, to) = (
            f64::from(lower.nonlinearity_error),
            f64::from(upper.nonlinearity_error),
        );
        from + (to - from) * fraction.clamp(0.0, 1.0)
    }

    /// The ghost at an angle; none beyond the table and where no light gets through.
    pub fn at(&self, angle: f64) -> Option<EvaluatedGhost> {
        let next = self.knots.iter().position(|knot| knot.angle >= angle)?;
        let light = |index: Option<usize>| {
            let knot = self.knots.get(index?)?;
            Some((knot.angle, knot.light.as_ref()?.unpack()))
        };
        let unpacked = if next == 0 || self.knots[next].angle == angle {
            light(Some(next))?.1
        } else {
            let near = [next.checked_sub(2), Some(next - 1), Some(next), Some(next + 1)].map(light);
            let near = near
                .each_ref()
                .map(|light| light.as_ref().map(|(angle, grid)| (*angle, grid)));
            between(near, angle)?
        };
        Some(EvaluatedGhost { unpacked })
    }
}

/// A grid and its angle.
pub type GridAt<'a> = (f64, &'a Unpacked);

/// Grids at an angle between knots, two on either side of it: cubic Hermite with the slopes of the parabola through each three angles; straight where
/// a neighbour is missing. None where either side lets no light through.
pub fn between([before, lower, upper, after]: [Option<GridAt<'_>>; 4], angle: f64) -> Option<Unpacked> {
    let (lower, upper) = (lower?, upper?);
    let mix = |of: &dyn Fn(&Unpacked) -> Option<f64>| {
        let point = |(angle, grid): GridAt<'_>| Some((angle, of(grid)?));
        let outer = |known: Option<GridAt<'_>>| known.and_then(point);
        hermite([outer(before), point(lower), point(upper), outer(after)], angle)
    };
    let bound = |k: usize| {
        let along = |axis: usize| mix(&|unpacked: &Unpacked| Some(unpacked.window[k][axis]));
        Some(DVec2::new(along(0)?, along(1)?))
    };
    let rays = |colour: usize| {
        (0..stored(lower.1.size))
            .map(|ray| {
                let mut values = [0.0; VALUES];
                for (k, value) in values.iter_mut().enumerate() {
                    *value =
                        mix(&|unpacked: &Unpacked| unpacked.colours[colour][ray].map(|values| values[k]))?;
                }
                Some(values)
            })
            .collect()
    };
    Some(Unpacked {
        size: lower.1.size,
        window: [bound(0)?, bound(1)?],
        colours: [rays(0), rays(1)],
        curve: {
            let mut curve = lower.1.curve;
            for (k, fraction) in curve.iter_mut().enumerate() {
                *fraction = mix(&|unpacked: &Unpacked| Some(unpacked.curve[k]))?;
            }
            curve
        },
    })
}

/// Through the two inner points, with the outer ones' help where they are known.
fn hermite(points: [Option<(f64, f64)>; 4], at: f64) -> Option<f64> {
    let [before, lower, upper, after] = points;
    let ((x1, y1), (x2, y2)) = (lower?, upper?);
    let span = x2 - x1;
    let secant = (y2 - y1) / span;
    // Slope at the point between two spans of the parabola through all three.
    let slope = |outer: Option<(f64, f64)>, x: f64, y: f64| {
        outer.map_or(secant, |(x0, y0)| {
            let distance = (x - x0).abs();
            let other = (y - y0) / (x - x0);
            (other * span + secant * distance) / (span + distance)
        })
    };
    let (m1, m2) = (slope(before, x1, y1), slope(after, x2, y2));
    let t = (at - x1) / span;
    let (t2, t3) = (t * t, t * t * t);
    Some(
        (2.0 * t3 - 3.0 * t2 + 1.0) * y1
            + (t3 - 2.0 * t2 + t) * span * m1
            + (3.0 * t2 - 2.0 * t3) * y2
            + (t3 - t2) * span * m2,
    )
}

impl EvaluatedGhost {
    /// Centre of the entrance window, millimetres.
    pub fn centre_mm(&self) -> DVec2 {
        0.5 * (self.unpacked.window[0] + self.unpacked.window[1])
    }

    /// Its rays in one colour, on a grid of `size` x `size` rays.
    pub fn grid(&self, wavelength_um: f64, size: usize) -> RayGrid {
        let inverse_square = |um: f64| um.powi(-2);
        let [blue, red] = COLOURS_UM.map(inverse_square);
        let fraction = (inverse_square(wavelength_um) - blue) / (red - blue);
        let known = self.unpacked.size;
        let coarse: Vec<Option<Values>> = (0..known * known)
            .map(|k| {
                // The other half is this one's mirror image.
                let (column, row) = (k % known, k / known);
                let (stored, mirror) = if row < known / 2 {
                    (row, 1.0)
                } else {
                    (known - 1 - row, -1.0)
                };
                let index = stored * known + column;
                let (a, b) = (self.unpacked.colours[0][index]?, self.unpacked.colours[1][index]?);
                let mut mixed: Values = std::array::from_fn(|k| a[k] + (b[k] - a[k]) * fraction);
                mixed[1] *= mirror;
                mixed[3] *= mirror;
                Some(mixed)
            })
            .collect();
        let fraction = fraction_at(&self.unpacked.curve, wavelength_um);
        let size = size.max(2);
        let ray = |value: Option<Values>| {
            value.map(|value| TracedRay {
                sensor_mm: DVec2::new(value[0], value[1]),
                stop_mm: DVec2::new(value[2], value[3]),
                relative_height: value[4],
                relative_stop: 0.0,
                power: value[5] * value[5] * fraction,
            })
        };
        let rays = smooth_grid(&coarse, known, size).into_iter().map(ray).collect();
        let [min, max] = self.unpacked.window;
        RayGrid { min, max, size, rays }
    }
}

/// The curve of colours at a wavelength, straight between its points.
fn fraction_at(curve: &[f64; CURVE_UM.len()], wavelength_um: f64) -> f64 {
    let last = CURVE_UM.len() - 2;
    let index = CURVE_UM
        .iter()
        .rposition(|&um| um <= wavelength_um)
        .unwrap_or(0)
        .min(last);
    let along = (wavelength_um - CURVE_UM[index]) / (CURVE_UM[index + 1] - CURVE_UM[index]);
    (curve[index] + (curve[index + 1] - curve[index]) * along).max(0.0)
}

/// A grid's values on another of `size` x `size` over the same rectangle: Catmull & Rom's spline (1974) along the rows, then along the
/// columns; straight between two where the ones beyond are missing.
pub fn smooth_grid(grid: &[Option<Values>], known: usize, size: usize) -> Vec<Option<Values>> {
    let position = |index: usize| index as f64 / (size - 1) as f64 * (known - 1) as f64;
    let along_rows: Vec<Option<Values>> = (0..known * size)
        .map(|k| {
            let row = &grid[k / size * known..][..known];
            spline(known, position(k % size), |column| row[column])
        })
        .collect();
    (0..size * size)
        .map(|k| spline(known, position(k / size), |row| along_rows[row * size + k % size]))
        .collect()
}

/// Between the values of a line of `known` of them.
fn spline(known: usize, at: f64, value: impl Fn(usize) -> Option<Values>) -> Option<Values> {
    let index = (at.floor() as usize).min(known - 2);
    let t = at - index as f64;
    let (p1, p2) = (value(index)?, value(index + 1)?);
    let beyond = |from: Values, to: Values| std::array::from_fn(|k| 2.0 * from[k] - to[k]);
    let p0 = index
        .checked_sub(1)
        .and_then(&value)
        .unwrap_or_else(|| beyond(p1, p2));
    let p3 = Some(index + 2)
        .filter(|&k| k < known)
        .and_then(&value)
        .unwrap_or_else(|| beyond(p2, p1));
    Some(std::array::from_fn(|k| {
        let (a, b, c, d) = (p0[k], p1[k], p2[k], p3[k]);
        0.5 * (2.0 * b
            + (c - a) * t
            + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t
            + (3.0 * b - a - 3.0 * c + d) * t * t * t)
    }))
}
