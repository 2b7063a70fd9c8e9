//! Buildings as walls and roofs of triangles, from the digital map (not from the building map, so that the two ways of
//! drawing check each other).

use bytemuck::{Pod, Zeroable};
use geo::{LineString, Polygon, TriangulateEarcut};
use glam::DVec3;

use crate::buildings::Building;

/// A vertex, 24 bytes.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct MeshVertex {
    /// Metres from the mesh's origin.
    pub position: [f32; 3],
    /// Facade coordinate, metres along the outline.
    pub along_m: f32,
    /// Octahedral normal, as `pack_normal` in `shaders/lib/frame.wgsl`.
    pub normal: u32,
    /// Id of the building.
    pub fid: u32,
}

/// Triangles of many buildings.
#[derive(Clone, Debug, Default)]
pub struct BuildingMesh {
    /// Vertices.
    pub vertices: Vec<MeshVertex>,
    /// Three indices a triangle, counter-clockwise from outside.
    pub indices: Vec<u32>,
}

/// How far walls reach below the base, metres: the ground beside a building can lie lower than at its corners.
const FOUNDATION_M: f64 = 60.0;

/// Raises every building.
pub fn building_mesh(buildings: &[Building], origin: DVec3) -> BuildingMesh {
    let mut mesh = BuildingMesh::default();
    for building in buildings {
        for polygon in &building.outline {
            for ring in std::iter::once(polygon.exterior()).chain(polygon.interiors()) {
                mesh.add_walls(building, ring, origin);
            }
            mesh.add_roof(building, polygon, origin);
        }
    }
    mesh
}

impl BuildingMesh {
    fn push(&mut self, position: DVec3, along_m: f64, normal: u32, fid: u32) -> u32 {
        self.vertices.push(MeshVertex {
            position: position.as_vec3().to_array(),
            along_m: along_m as f32,
            normal,
            fid,
        });
        self.vertices.len() as u32 - 1
    }

    fn add_walls(&mut self, building: &Building, ring: &LineString<f64>, origin: DVec3) {
        let mut along = 0.0;
        for edge in ring.lines() {
            let length = edge.dx().hypot(edge.dy());
            let normal = pack_normal([edge.dy() / length, -edge.dx() / length, 0.0]);
            let corners = [(edge.start, 0.0), (edge.end, length)].map(|(point, u)| {
                [building.base_m - FOUNDATION_M, building.roof_m].map(|height| {
                    self.push(
                        DVec3::new(point.x, point.y, height) - origin,
                        along + u,
                        normal,
                        building.fid,
                    )
                })
            });
            let [[a, d], [b, c]] = corners;
            self.indices.extend([a, b, c, a, c, d]);
            along += length;
        }
    }

    fn add_roof(&mut self, building: &Building, polygon: &Polygon<f64>, origin: DVec3) {
        let up = pack_normal([0.0, 0.0, 1.0]);
        let raw = polygon.earcut_triangles_raw();
        let first = self.vertices.len() as u32;
        for point in &raw.vertices {
            let position = DVec3::new(point[0], point[1], building.roof_m) - origin;
            self.push(position, 0.0, up, building.fid);
        }
        for triangle in raw.triangle_indices.chunks_exact(3) {
            let corner = |k: usize| raw.vertices[triangle[k]];
            let [a, b, c] = [corner(0), corner(1), corner(2)];
            let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let order = if turn >= 0.0 { [0, 1, 2] } else { [0, 2, 1] };
            self.indices.extend(order.map(|k| first + triangle[k] as u32));
        }
    }
}

/// Octahedral map of a unit vector to two 16-bit numbers (Cigolle et al. 2014), as the shaders unpack it.
fn pack_normal([x, y, z]: [f64; 3]) -> u32 {
    let sum = x.abs() + y.abs() + z.abs();
    let (mut u, mut v) = (x / sum, y / sum);
    if z < 0.0 {
        let sign = |value: f64| if value >= 0.0 { 1.0 } else { -1.0 };
        (u, v) = ((1.0 - v.abs()) * sign(u), (1.0 - u.abs()) * sign(v));
    }
    let bits = |value: f64| u32::from((value.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    bits(u) | (bits(v) << 16)
}
