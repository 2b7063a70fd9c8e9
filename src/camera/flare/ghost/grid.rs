//! A ghost as a grid of rays over the part of the entrance that lets its light in.

use glam::DVec2;

use super::linear::{LinearGhost, MAX_SOFTNESS};
use super::softness::Softness;
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

/// How often a search looks closer.
pub const CLOSER_LOOKS: usize = 2;
/// Rays of a search that get through, from which on it has missed none.
const ENOUGH_RAYS: usize = 60;
/// By how much rays miss iris and barrel round which a search looks closer, at most by the nearest.
const NEARLY: f64 = 1.8;

/// Height of a ray that gets lost, at least.
const LOST_HEIGHT: f64 = 1.05;

/// How a grid is drawn.
#[derive(Clone, Copy)]
pub struct GridDrawing {
    /// The light.
    pub source: FlareSource,
    /// The colour.
    pub colour: Wavelength,
    /// Radius of the iris, millimetres.
    pub stop_mm: f64,
    /// How the ghost is softened.
    pub softness: Softness,
    /// Of the ghost's radiance.
    pub fraction: f64,
    /// Of what lies below, hidden.
    pub opacity: f64,
}

/// Height by the barrel up to which triangles are drawn: the edge is as soft as a texel at least.
const EDGE_HEIGHT: f64 = 1.2;

/// How much brighter a vertex may be than its triangle alone.
const MAX_BRIGHTER: f64 = 2.0;

/// Height in the stop, in radii of the iris, up to which a point of light's rays are kept.
pub const MARGIN_STOP: f64 = 1.05;

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

    /// Without any ray yet.
    pub fn empty(bundle: &Bundle, size: usize) -> Self {
        Self::new(bundle, size, vec![None; size * size])
    }

    /// Takes a block's rays over, from a column and a row on.
    pub fn set_block(&mut self, [column, row]: [usize; 2], block: &Self) {
        for (k, line) in block.rays.chunks_exact(block.size).enumerate() {
            let first = (row + k) * self.size + column;
            self.rays[first..first + block.size].copy_from_slice(line);
        }
    }

    /// Where ray `k` comes in, millimetres.
    pub fn entry(&self, k: usize) -> DVec2 {
        let fraction = DVec2::new((k % self.size) as f64, (k / self.size) as f64) / (self.size - 1) as f64;
        self.min + (self.max - self.min) * fraction
    }

    /// Of a grid over the whole entrance: where to look closer, as so few of its rays get through that it may have missed some: round
    /// those that come nearest to it. None where it needs no closer look, or all rays are lost.
    pub fn closer(&self, linear: &LinearGhost) -> Option<[DVec2; 2]> {
        let miss = |ray: &TracedRay| ray.relative_height.max(ray.stop_mm.length() / linear.stop_mm);
        let misses = || self.rays.iter().flatten().map(miss);
        if misses().filter(|miss| *miss <= 1.0).count() >= ENOUGH_RAYS {
            return None;
        }
        let most = NEARLY * misses().fold(f64::INFINITY, f64::min).max(1.0);
        self.around(self.cell(), |ray| miss(ray) <= most)
            .map(|[min, max]| [min.max(self.min), max.min(self.max)])
    }

    /// Of a grid over the whole entrance: the part that gets through, with a cell round it and the linear pupil; none when
    /// nothing does. `max_stop` is the height in the stop up to which rays count, in radii of the iris.
    pub fn window(&self, linear: &LinearGhost, max_stop: f64) -> Option<[DVec2; 2]> {
        let all = DVec2::splat(linear.barrel_mm);
        let pupil = [linear.centre - linear.half, linear.centre + linear.half];
        let passing = self.around(DVec2::splat(self.cell().max_element()), |ray| {
            passes(ray, linear, max_stop)
        });
        let [min, max] = match passing {
            Some([min, max]) if linear.is_shut() => [min, max],
            Some([min, max]) => [min.min(pupil[0]), max.max(pupil[1])],
            None if linear.is_shut() => return None,
            None => pupil,
        };
        let (min, max) = (min.max(-all), max.min(all));
        (min.x < max.x && min.y < max.y).then_some([min, max])
    }

    /// Of a grid over a window: where light comes in, or nearly. Column and row of the first ray of each block of `block` x `block` rays of a
    /// grid of `size` x `size` rays over the same window that lies there or a cell beside it.
    pub fn lit_blocks(&self, linear: &LinearGhost, (size, block): (usize, usize)) -> Vec<[usize; 2]> {
        let near: Vec<DVec2> = (0..self.rays.len())
            .filter(|&k| {
                self.rays[k].as_ref().is_some_and(|ray| {
                    ray.relative_height <= NEARLY && ray.stop_mm.length() <= NEARLY * linear.stop_mm
                })
            })
            .map(|k| DVec2::new((k % self.size) as f64, (k / self.size) as f64))
            .collect();
        let scale = (self.size - 1) as f64 / (size - 1) as f64;
        let is_lit = |&[column, row]: &[usize; 2]| {
            let first = DVec2::new(column as f64, row as f64) * scale - 1.0;
            let last = first + (block - 1) as f64 * scale + 2.0;
            near.iter()
                .any(|at| at.cmpge(first).all() && at.cmple(last).all())
        };
        blocks(size, block).filter(is_lit).collect()
    }

    /// Size of its cells, millimetres.
    fn cell(&self) -> DVec2 {
        (self.max - self.min) / (self.size - 1) as f64
    }

    /// Least and greatest coordinates of some of the rays, with a margin round them.
    fn around(&self, margin: DVec2, is_meant: impl Fn(&TracedRay) -> bool) -> Option<[DVec2; 2]> {
        let meant = self.rays.iter().enumerate().filter_map(|(k, ray)| {
            let is_meant = ray.as_ref().is_some_and(&is_meant);
            is_meant.then(|| [self.entry(k) - margin, self.entry(k) + margin])
        });
        meant.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Continues a grid straight over lost rays that have two neighbours in a line: their cells are cut, not left out.
    pub fn extend(&mut self) {
        let (before, size) = (self.rays.clone(), self.size);
        let at = |column: Option<usize>, row: Option<usize>| {
            let (column, row) = (column?, row?);
            (column < size && row < size).then(|| before[row * size + column])?
        };
        for (k, ray) in self.rays.iter_mut().enumerate() {
            if ray.is_some() {
                continue;
            }
            let (column, row) = (k % size, k / size);
            let neighbours = [1, 2].map(|far: usize| {
                [
                    at(column.checked_sub(far), Some(row)),
                    at(Some(column + far), Some(row)),
                    at(Some(column), row.checked_sub(far)),
                    at(Some(column), Some(row + far)),
                ]
            });
            let guesses: Vec<TracedRay> = (0..4)
                .filter_map(|direction| {
                    let (near, far) = (neighbours[0][direction]?, neighbours[1][direction]?);
                    Some(TracedRay {
                        stop_mm: 2.0 * near.stop_mm - far.stop_mm,
                        sensor_mm: 2.0 * near.sensor_mm - far.sensor_mm,
                        relative_height: (2.0 * near.relative_height - far.relative_height).max(LOST_HEIGHT),
                        relative_stop: near.relative_stop,
                        power: (2.0 * near.power - far.power).max(0.0),
                    })
                })
                .collect();
            // Of several, the one that lies highest: the others may come round the edge.
            *ray = guesses
                .into_iter()
                .max_by(|a, b| a.relative_height.total_cmp(&b.relative_height));
        }
    }

    /// Triangles on the sensor.
    pub fn triangles(&self, drawing: &GridDrawing) -> Vec<FlareVertex> {
        let GridDrawing {
            source,
            colour,
            stop_mm,
            softness,
            fraction,
            opacity,
        } = *drawing;
        let [max_stop, max_height] = [softness.stop, softness.front].map(|radius| radius.min(MAX_SOFTNESS));
        let (min, max, size, rays) = (self.min, self.max, self.size, &self.rays);
        let cell = (max - min).element_product() / ((size - 1) * (size - 1)) as f64;
        let mut triangles: Vec<[usize; 3]> = Vec::new();
        // Areas that the triangles round each ray land on, and their number: those that keep their orientation, and those that do not.
        let mut landed = vec![[(0.0, 0_u32); 2]; size * size];
        for row in 0..size - 1 {
            for column in 0..size - 1 {
                let first = row * size + column;
                let [a, b, c, d] = [first, first + 1, first + size + 1, first + size];
                if [a, b, c, d].iter().any(|&k| rays[k].is_none()) {
                    continue;
                }
                for triangle in [[a, b, c], [a, c, d]] {
                    let area = signed_area(triangle.map(|k| rays[k]));
                    for k in triangle {
                        let (sum, count) = &mut landed[k][usize::from(area < 0.0)];
                        *sum += area.abs();
                        *count += 1;
                    }
                    triangles.push(triangle);
                }
            }
        }
        let mut vertices: Vec<FlareVertex> = Vec::with_capacity(3 * triangles.len());
        // What the triangles get, and what they would be drawn with.
        let (mut given, mut drawn) = (0.0, 0.0);
        for triangle in triangles {
            let corners = triangle.map(|k| rays[k]);
            let nearest = |of: &dyn Fn(&TracedRay) -> f64| {
                corners.iter().flatten().map(of).fold(f64::INFINITY, f64::min)
            };
            let area = signed_area(corners);
            if nearest(&|ray| ray.relative_height) > EDGE_HEIGHT + max_height
                || nearest(&|ray| ray.stop_mm.length() / stop_mm) > 1.5 + max_stop
                || area.abs() < 1e-12
            {
                continue;
            }
            let light = corners.iter().flatten().map(|ray| ray.power).sum::<f64>() / 3.0;
            given += light * 0.5 * cell;
            for (k, ray) in triangle.into_iter().zip(corners.into_iter().flatten()) {
                // The mean round the ray, so that no triangle is told from its neighbours; but none so bright that it would have
                // more light than it gets.
                let (sum, count) = landed[k][usize::from(area < 0.0)];
                let areas = (0.5 * cell * f64::from(count) / sum).min(MAX_BRIGHTER * 0.5 * cell / area.abs());
                drawn += ray.power * areas * area.abs() / 3.0;
                vertices.push(FlareVertex {
                    sensor_mm: source.rotated(ray.sensor_mm),
                    stop: source.rotated(ray.stop_mm / -stop_mm),
                    barrel: [ray.relative_height as f32, 0.0],
                    radiance: source.radiance(colour, fraction * ray.power, areas),
                    opacity: opacity as f32,
                });
            }
        }
        if drawn > 0.0 {
            let scale = (given / drawn) as f32;
            for vertex in &mut vertices {
                vertex.radiance = vertex.radiance.map(|channel| channel * scale);
            }
        }
        vertices
    }
}

/// Whether a ray gets through the barrel, or nearly, and no higher through the stop than so many radii of the iris.
fn passes(ray: &TracedRay, linear: &LinearGhost, max_stop: f64) -> bool {
    ray.relative_height <= 1.05 && ray.stop_mm.length() <= max_stop * linear.stop_mm
}

/// Column and row of the first ray of each block of a grid of `size` x `size` rays; the last ones overlap those before where they must.
pub fn blocks(size: usize, block: usize) -> impl Iterator<Item = [usize; 2]> {
    let firsts = move || (0..size.div_ceil(block)).map(move |k| (k * block).min(size - block));
    firsts().flat_map(move |row| firsts().map(move |column| [column, row]))
}

/// Area that three rays land on, negative where the ghost is upside down there.
fn signed_area(rays: [Option<TracedRay>; 3]) -> f64 {
    let [a, b, c] = rays.map(|ray| ray.map_or(DVec2::ZERO, |ray| ray.sensor_mm));
    0.5 * (b - a).perp_dot(c - a)
}

#[cfg(test)]
mod tests {
    use super::blocks;

    #[test]
    fn blocks_cover_a_grid_and_no_more() {
        for (size, block) in [(2, 2), (9, 9), (10, 10), (11, 10), (40, 10), (79, 10), (80, 10)] {
            let mut covered = vec![false; size * size];
            for [column, row] in blocks(size, block) {
                assert!(
                    column + block <= size && row + block <= size,
                    "{size}: {column}, {row}"
                );
                for k in 0..block * block {
                    covered[(row + k / block) * size + column + k % block] = true;
                }
            }
            assert!(
                covered.into_iter().all(|is_covered| is_covered),
                "{size} by {block}"
            );
        }
    }
}
