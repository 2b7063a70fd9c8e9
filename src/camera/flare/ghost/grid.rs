//! A ghost as a grid of rays over the part of the entrance that lets its light in.

use glam::DVec2;

use super::linear::LinearGhost;
use super::vertex::{FlareSource, FlareVertex};
use crate::camera::flare::Wavelength;
use crate::camera::ray_bundles::Bundle;
use crate::camera::trace::TracedRay;

/// Rays row by row over a rectangle of the entrance.
#[derive(Clone, Debug)]
pub struct RayGrid {
    /// Least coordinates, millimetres.
    pub min: DVec2,
    /// Greatest coordinates.
    pub max: DVec2,
    /// Rays along an edge.
    pub size: usize,
    /// The rays; none where one gets lost.
    pub rays: Vec<Option<TracedRay>>,
}

/// Rays along an edge of the grid that finds where a ghost's light comes in.
pub const SEARCH_RAYS: usize = 25;

impl RayGrid {
    /// A bundle's rays.
    pub fn new(bundle: &Bundle, size: usize, rays: Vec<Option<TracedRay>>) -> Self {
        Self {
            min: bundle.min,
            max: bundle.max,
            size,
            rays,
        }
    }

    /// Where ray `k` comes in, millimetres.
    pub fn entry(&self, k: usize) -> DVec2 {
        let fraction = DVec2::new((k % self.size) as f64, (k / self.size) as f64) / (self.size - 1) as f64;
        self.min + (self.max - self.min) * fraction
    }

    /// Of a grid over the whole entrance: the part that gets through, with a cell round it and the linear pupil; none when
    /// nothing does.
    pub fn window(&self, linear: &LinearGhost) -> Option<[DVec2; 2]> {
        let all = DVec2::splat(linear.barrel_mm);
        let cell = 2.0 * linear.barrel_mm / (self.size - 1) as f64;
        let (mut min, mut max) = (linear.centre - linear.half, linear.centre + linear.half);
        if linear.is_shut() {
            (min, max) = (all, -all);
        }
        for (k, ray) in self.rays.iter().enumerate() {
            let passes = |ray: &TracedRay| {
                ray.relative_height <= 1.05 && ray.stop_mm.length() <= 1.05 * linear.stop_mm
            };
            if ray.as_ref().is_some_and(passes) {
                min = min.min(self.entry(k) - cell);
                max = max.max(self.entry(k) + cell);
            }
        }
        let (min, max) = (min.max(-all), max.min(all));
        (min.x < max.x && min.y < max.y).then_some([min, max])
    }

    /// Triangles on the sensor, of a fraction of the ghost's radiance and an opacity.
    pub fn triangles(
        &self,
        source: &FlareSource,
        colour: Wavelength,
        stop_mm: f64,
        fraction: f64,
        opacity: f64,
    ) -> Vec<FlareVertex> {
        let (min, max, size, rays) = (self.min, self.max, self.size, &self.rays);
        let area = (max - min).element_product() / ((size - 1) * (size - 1)) as f64;
        let mut vertices = Vec::new();
        for row in 0..size - 1 {
            for column in 0..size - 1 {
                let at = |dx: usize, dy: usize| rays[(row + dy) * size + column + dx];
                let (Some(a), Some(b), Some(c), Some(d)) = (at(0, 0), at(1, 0), at(1, 1), at(0, 1)) else {
                    continue;
                };
                for triangle in [[a, b, c], [a, c, d]] {
                    let nearest = |key: fn(&TracedRay, f64) -> f64| {
                        triangle
                            .iter()
                            .map(|ray| key(ray, stop_mm))
                            .fold(f64::INFINITY, f64::min)
                    };
                    if nearest(|ray, _| ray.relative_height) > 1.0
                        || nearest(|ray, stop_mm| ray.stop_mm.length() / stop_mm) > 1.5
                    {
                        continue;
                    }
                    let [p, q, r] = triangle.map(|ray| ray.sensor_mm);
                    let landed = 0.5 * (q - p).perp_dot(r - p).abs();
                    if landed < 1e-12 {
                        continue;
                    }
                    vertices.extend(triangle.map(|ray| FlareVertex {
                        sensor_mm: source.rotated(ray.sensor_mm),
                        stop: source.rotated(ray.stop_mm / -stop_mm),
                        barrel: [ray.relative_height as f32, 0.0],
                        radiance: source.radiance(colour, fraction * ray.power, 0.5 * area / landed),
                        opacity: opacity as f32,
                    }));
                }
            }
        }
        vertices
    }
}
