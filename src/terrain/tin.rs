//! A TIN by greedy insertion: of all positions of the mesh lattice the one farthest from the surface
//! becomes a vertex, until none is farther than the tolerance (Garland & Heckbert 1995, algorithm III:
//! each triangle keeps its own worst sample and only triangles touched by an insertion are scanned again).
//! The Delaunay triangulation is `spade`'s.

use std::collections::BinaryHeap;

use spade::handles::{FixedFaceHandle, InnerTag};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::HeightTile;
use super::profile::profile_vertices;

/// Samples one step beyond the tile's border on all sides, `(side + 2)²`, so that both neighbours of a border
/// know which of its samples touch missing ground.
pub struct Apron<'a>(pub &'a [f32]);

#[derive(Clone, Copy)]
struct Sample {
    i: u16,
    j: u16,
    height: f32,
}

impl HasPosition for Sample {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        Point2::new(f64::from(self.i), f64::from(self.j))
    }
}

/// A triangle's worst sample; ordered by its error, then by place so that the result is the same everywhere.
#[derive(PartialEq)]
struct Candidate {
    error: f32,
    sample: u32,
    face: usize,
    version: u32,
}

impl Eq for Candidate {}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.error
            .total_cmp(&other.error)
            .then(other.sample.cmp(&self.sample))
            .then(other.face.cmp(&self.face))
            .then(self.version.cmp(&other.version))
    }
}

/// Triangles as indices of mesh positions (`HeightTile::mesh_parts`), counter-clockwise from above, within `tolerance_m`
/// of the bilinear surface at every one of them. Triangles over missing ground are left out; their border is exact.
pub fn tin_triangles(tile: &HeightTile, apron: &Apron<'_>, tolerance_m: f32) -> Vec<[u32; 3]> {
    let parts = tile.mesh_parts();
    let mesh_tile = &tile.refined(parts);
    let mut tin = Tin {
        tile: mesh_tile,
        mesh: DelaunayTriangulation::new(),
        versions: Vec::new(),
        heap: BinaryHeap::new(),
        tolerance_m,
    };
    let mut fixed = border_vertices(tile, tolerance_m);
    fixed.extend(hole_vertices(mesh_tile, tile.side, parts, apron));
    fixed.sort_unstable_by_key(|&(i, j)| (j, i));
    fixed.dedup();
    for (i, j) in fixed {
        tin.insert(i, j);
    }
    tin.scan_all();
    while let Some(candidate) = tin.heap.pop() {
        if tin.versions[candidate.face] != candidate.version {
            continue;
        }
        let (i, j) = (
            candidate.sample as usize % mesh_tile.side,
            candidate.sample as usize / mesh_tile.side,
        );
        if let Some(vertex) = tin.insert(i, j) {
            let touched: Vec<_> = tin
                .mesh
                .vertex(vertex)
                .out_edges()
                .filter_map(|edge| edge.face().as_inner().map(|face| face.fix()))
                .collect();
            for face in touched {
                tin.scan(face);
            }
        }
    }
    tin.triangles()
}

/// Mesh positions on the border that become vertices. Along it the surface bends at samples alone, so only they are asked.
fn border_vertices(tile: &HeightTile, tolerance_m: f32) -> Vec<(usize, usize)> {
    let (side, parts) = (tile.side, tile.mesh_parts());
    let last = side - 1;
    let border = |at: &dyn Fn(usize) -> (usize, usize)| -> Vec<(usize, usize)> {
        let heights: Vec<f32> = (0..side)
            .map(at)
            .map(|(i, j)| tile.heights[j * side + i])
            .collect();
        profile_vertices(&heights, tolerance_m)
            .into_iter()
            .map(at)
            .map(|(i, j)| (i * parts, j * parts))
            .collect()
    };
    let mut vertices = border(&|k| (k, 0));
    vertices.extend(border(&|k| (k, last)));
    vertices.extend(border(&|k| (0, k)));
    vertices.extend(border(&|k| (last, k)));
    vertices
}

/// Every known mesh position beside a missing one; `samples` is the side of the tile's own lattice.
fn hole_vertices(mesh: &HeightTile, samples: usize, parts: usize, apron: &Apron<'_>) -> Vec<(usize, usize)> {
    if apron.0.iter().all(|height| height.is_finite()) {
        return Vec::new();
    }
    let wide = HeightTile {
        side: samples + 2,
        level: mesh.level,
        step_m: mesh.step_m * parts as f64,
        heights: apron.0.to_vec(),
    };
    let wide = wide.refined(parts);
    let known = |i: usize, j: usize| wide.heights[j * wide.side + i].is_finite();
    let mut vertices = Vec::new();
    for j in 0..mesh.side {
        for i in 0..mesh.side {
            let (i_wide, j_wide) = (i + parts, j + parts);
            let missing_near = (0..9).any(|n| !known(i_wide + n % 3 - 1, j_wide + n / 3 - 1));
            if missing_near && known(i_wide, j_wide) {
                vertices.push((i, j));
            }
        }
    }
    vertices
}

struct Tin<'a> {
    tile: &'a HeightTile,
    mesh: DelaunayTriangulation<Sample>,
    versions: Vec<u32>,
    heap: BinaryHeap<Candidate>,
    tolerance_m: f32,
}

impl Tin<'_> {
    fn insert(&mut self, i: usize, j: usize) -> Option<spade::handles::FixedVertexHandle> {
        let sample = Sample {
            i: i as u16,
            j: j as u16,
            height: self.tile.heights[j * self.tile.side + i],
        };
        // Coordinates are small whole numbers: spade's range errors cannot arise.
        self.mesh.insert(sample).ok()
    }

    fn scan_all(&mut self) {
        let faces: Vec<_> = self.mesh.inner_faces().map(|face| face.fix()).collect();
        for face in faces {
            self.scan(face);
        }
    }

    /// Finds the face's worst sample and queues it when it is beyond the tolerance.
    fn scan(&mut self, face: FixedFaceHandle<InnerTag>) {
        let corners = self.mesh.face(face).vertices().map(|vertex| *vertex.data());
        let index = face.index();
        if self.versions.len() <= index {
            self.versions.resize(index + 1, 0);
        }
        self.versions[index] += 1;
        if let Some((error, sample)) = worst_sample(self.tile, corners, self.tolerance_m) {
            self.heap.push(Candidate {
                error,
                sample,
                face: index,
                version: self.versions[index],
            });
        }
    }

    fn triangles(&self) -> Vec<[u32; 3]> {
        let side = self.tile.side;
        let known = |i: usize, j: usize| self.tile.heights[j * side + i].is_finite();
        self.mesh
            .inner_faces()
            .map(|face| face.vertices().map(|vertex| *vertex.data()))
            .filter(|corners| {
                let centre = |of: fn(&Sample) -> u16| {
                    let sum: usize = corners.iter().map(|corner| usize::from(of(corner))).sum();
                    (sum / 3).min(side - 2)
                };
                let (i, j) = (centre(|corner| corner.i), centre(|corner| corner.j));
                known(i, j) && known(i + 1, j) && known(i, j + 1) && known(i + 1, j + 1)
            })
            .map(|corners| corners.map(|corner| u32::from(corner.j) * side as u32 + u32::from(corner.i)))
            .collect()
    }
}

/// The known sample inside the triangle that is farthest from its plane, if farther than the tolerance.
fn worst_sample(tile: &HeightTile, corners: [Sample; 3], tolerance_m: f32) -> Option<(f32, u32)> {
    let x = corners.map(|corner| f64::from(corner.i));
    let y = corners.map(|corner| f64::from(corner.j));
    let z = corners.map(|corner| f64::from(corner.height));
    let doubled_area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    if doubled_area <= 0.0 {
        return None;
    }
    let slope_x = ((z[1] - z[0]) * (y[2] - y[0]) - (z[2] - z[0]) * (y[1] - y[0])) / doubled_area;
    let slope_y = ((x[1] - x[0]) * (z[2] - z[0]) - (x[2] - x[0]) * (z[1] - z[0])) / doubled_area;
    let lowest = |values: [f64; 3]| values.into_iter().fold(f64::INFINITY, f64::min);
    let highest = |values: [f64; 3]| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let mut worst: Option<(f32, u32)> = None;
    for row in lowest(y) as usize..=highest(y) as usize {
        // The span of the row inside all three edges.
        let (mut from, mut to) = (lowest(x), highest(x));
        for k in 0..3 {
            let next = (k + 1) % 3;
            let (dx, dy) = (x[next] - x[k], y[next] - y[k]);
            // Inside: dx * (row - y) - dy * (column - x) >= 0.
            let level = dx * (row as f64 - y[k]);
            if dy > 0.0 {
                to = to.min(x[k] + level / dy);
            } else if dy < 0.0 {
                from = from.max(x[k] + level / dy);
            }
        }
        if from > to {
            continue;
        }
        let base = z[0] + slope_y * (row as f64 - y[0]) - slope_x * x[0];
        for column in (from - 1e-9).ceil() as usize..=(to + 1e-9).floor() as usize {
            // The border's vertices follow from its profile alone, or neighbours could choose differently.
            let inner = 1..tile.side - 1;
            if !inner.contains(&row) || !inner.contains(&column) {
                continue;
            }
            let sample = row * tile.side + column;
            let error = (f64::from(tile.heights[sample]) - base - slope_x * column as f64).abs() as f32;
            if error > worst.map_or(tolerance_m, |(error, _)| error) {
                worst = Some((error, sample as u32));
            }
        }
    }
    worst
}
