//! A ghost drawn from its linear image: the flare quad, from four entrance points or from two.
//!
//! KR 10-1465658; Lee & Eisemann 2013, section 4.

use glam::DVec2;

use super::linear::LinearGhost;
use super::vertex::{FlareSource, FlareVertex};
use crate::camera::flare::Wavelength;
use crate::camera::path::Ghost;
use crate::camera::trace::{Tracer, beam_direction};

/// Columns and rows of two triangles' vertices.
const VERTICES: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)];

/// Fraction of the distance from a quad's centre to its edge where a ray still passes the iris.
const INNER: f64 = 0.6;

/// The flare quad of a ghost: four entrance points, each carried by the matrices.
pub fn quad(
    tracer: &Tracer<'_>,
    linear: &LinearGhost,
    colour: Wavelength,
    source: &FlareSource,
    ghost: Ghost,
) -> Vec<FlareVertex> {
    let Some(losses) = Losses::from_ray(tracer, linear, source, ghost) else {
        return Vec::new();
    };
    let vertex = |column: usize, row: usize| {
        let unit = DVec2::new(column as f64, row as f64) * 2.0 - 1.0;
        let entry = linear.quad[0] + linear.quad[1] * unit;
        let radiance = source.radiance(colour, losses.power_at(entry), linear.f[0].powi(-2));
        FlareVertex {
            sensor_mm: source.rotated(linear.sensor(entry)),
            stop: source.rotated(linear.stop(entry) / -linear.stop_mm),
            barrel: source.rotated(entry / linear.barrel_mm),
            radiance,
            opacity: 0.0,
        }
    };
    VERTICES.map(|(column, row)| vertex(column, row)).to_vec()
}

/// The same from two rays, through the centre of the pupil and through its farthest point: the linear image is similar to the
/// entrance, so that they tell a square sprite's centre and half its size, on the sensor and in the stop.
pub fn two_rays(
    tracer: &Tracer<'_>,
    linear: &LinearGhost,
    colour: Wavelength,
    source: &FlareSource,
    ghost: Ghost,
) -> Vec<FlareVertex> {
    let Some(losses) = Losses::from_ray(tracer, linear, source, ghost) else {
        return Vec::new();
    };
    let [centre, half] = linear.quad;
    let [start, end] =
        [centre, centre + half].map(|entry| [linear.sensor(entry), linear.stop(entry) / -linear.stop_mm]);
    // Of what is drawn by what comes in, negative where the image is upside down.
    let scale = |k: usize| (end[k] - start[k]).dot(half) / half.length_squared();
    // Brightness by the ratio of the two areas.
    let areas = scale(0).powi(-2);
    let half_extent = half.max_element();
    let sprite = |k: usize, unit: DVec2| start[k] + scale(k) * half_extent * unit;
    VERTICES
        .map(|(column, row)| {
            let unit = DVec2::new(column as f64, row as f64) * 2.0 - 1.0;
            let entry = centre + half_extent * unit;
            FlareVertex {
                sensor_mm: source.rotated(sprite(0, unit)),
                stop: source.rotated(sprite(1, unit)),
                barrel: source.rotated(entry / linear.barrel_mm),
                radiance: source.radiance(colour, losses.power_at(entry), areas),
                opacity: 0.0,
            }
        })
        .to_vec()
}

/// Fraction of the power that arrives, linear over the entrance.
pub struct Losses {
    centre: DVec2,
    power: f64,
    slope: DVec2,
}

impl Losses {
    /// At the true angles of the ray through the centre (of an axial one where that ray does not arrive), changing by rays to
    /// either side that the iris still lets through. None when neither arrives, or
    /// nothing of the pupil lies within the barrel.
    pub fn from_ray(
        tracer: &Tracer<'_>,
        linear: &LinearGhost,
        source: &FlareSource,
        ghost: Ghost,
    ) -> Option<Self> {
        if linear.is_shut() {
            return None;
        }
        let centre = tracer.trace(Some(ghost), linear.centre, beam_direction(source.angle));
        let axial = || tracer.trace(Some(ghost), DVec2::ZERO, beam_direction(0.0));
        let power = centre.or_else(axial)?.power;
        let beside = |offset: DVec2| {
            let inner = linear.centre + INNER * linear.half * offset;
            tracer
                .trace(Some(ghost), inner, beam_direction(source.angle))
                .map_or(power, |ray| ray.power)
        };
        let slope = DVec2::new(
            beside(DVec2::X) - beside(DVec2::NEG_X),
            beside(DVec2::Y) - beside(DVec2::NEG_Y),
        ) / (2.0 * INNER * linear.half);
        Some(Self {
            centre: linear.centre,
            power,
            slope,
        })
    }

    /// At a point of the entrance, millimetres.
    pub fn power_at(&self, entry: DVec2) -> f64 {
        self.power + self.slope.dot(entry - self.centre)
    }
}
