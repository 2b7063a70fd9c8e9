//! Buildings as walls and roofs of triangles, from the footprint dataset (not from the building map, so that the two ways of
//! drawing check each other).

use std::collections::BTreeMap;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use geo::{LineString, Polygon, TriangulateEarcut};
use glam::DVec3;

use crate::buildings::{Building, facade_coordinates};
use crate::space::Bounds;

/// A vertex, 40 bytes.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct MeshVertex {
    /// Metres from the mesh's origin.
    pub position: [f32; 3],
    /// Facade coordinate, bays along the outline.
    pub bays: f32,
    /// Octahedral normal, as `pack_normal` in `shaders/lib/frame.wgsl`.
    pub normal: u32,
    /// Id of the building.
    pub fid: u32,
    /// What the building is made of.
    pub material: u32,
    /// Bays a metre, 0 on a roof; elevation of the base, metres from the mesh's origin; height of the roof above it, metres.
    pub facade: [f32; 3],
}

impl MeshVertex {
    /// As `shaders/relief/polygons.wgsl` takes them.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32, 2 => Uint32, 3 => Uint32, 4 => Uint32, 5 => Float32x3
    ];
}

/// Triangles of many buildings.
#[derive(Clone, Debug, Default)]
pub struct BuildingMesh {
    /// Vertices.
    pub vertices: Vec<MeshVertex>,
    /// Three indices a triangle, counter-clockwise from outside.
    pub indices: Vec<u32>,
    /// Neighbouring buildings, drawn or left out together.
    pub blocks: Vec<MeshBlock>,
}

/// Neighbouring buildings of a mesh.
#[derive(Clone, Debug)]
pub struct MeshBlock {
    /// Rectangle of their outlines, world metres.
    pub bounds: Bounds,
    /// Lowest and highest elevation, metres.
    pub range: [f64; 2],
    /// Their part of the mesh's indices.
    pub indices: Range<u32>,
}

/// How far walls reach below the base, metres: the ground beside a building can lie lower than at its corners.
const FOUNDATION_M: f64 = 60.0;

/// Side of the squares by which buildings are drawn or left out together, metres.
const BLOCK_M: f64 = 256.0;

/// Raises every building.
pub fn building_mesh(buildings: &[Building], origin: DVec3) -> BuildingMesh {
    let mut blocks: BTreeMap<[i64; 2], Vec<&Building>> = BTreeMap::new();
    for building in buildings {
        let centre = building.bounds().centre();
        let square = [centre.y, centre.x].map(|metres| (metres / BLOCK_M).floor() as i64);
        blocks.entry(square).or_default().push(building);
    }
    let mut mesh = BuildingMesh::default();
    for of_block in blocks.values() {
        mesh.add_block(of_block, origin);
    }
    mesh
}

impl BuildingMesh {
    fn add_block(&mut self, buildings: &[&Building], origin: DVec3) {
        let first = self.indices.len() as u32;
        let (mut bounds, mut range) = (Bounds::EMPTY, [f64::INFINITY, f64::NEG_INFINITY]);
        for building in buildings {
            bounds = bounds.union(&building.bounds());
            range = [
                range[0].min(building.base_m - FOUNDATION_M),
                range[1].max(building.roof_m),
            ];
            for polygon in &building.outline {
                for ring in std::iter::once(polygon.exterior()).chain(polygon.interiors()) {
                    self.add_walls(building, ring, origin);
                }
                self.add_roof(building, polygon, origin);
            }
        }
        self.blocks.push(MeshBlock {
            bounds,
            range,
            indices: first..self.indices.len() as u32,
        });
    }

    /// `bays`: the facade coordinate, and bays a metre.
    fn push(&mut self, building: &Building, position: DVec3, bays: [f64; 2], origin: DVec3) -> u32 {
        let facade = [
            bays[1],
            building.base_m - origin.z,
            building.roof_m - building.base_m,
        ];
        self.vertices.push(MeshVertex {
            position: (position - origin).as_vec3().to_array(),
            bays: bays[0] as f32,
            normal: 0,
            fid: building.fid,
            material: building.material.code(),
            facade: facade.map(|value| value as f32),
        });
        self.vertices.len() as u32 - 1
    }

    fn add_walls(&mut self, building: &Building, ring: &LineString<f64>, origin: DVec3) {
        let bays = facade_coordinates(ring, building.material.facade.bay_m);
        for (edge, bays) in ring.lines().zip(bays.windows(2)) {
            let length = edge.dx().hypot(edge.dy());
            let normal = pack_normal([edge.dy() / length, -edge.dx() / length, 0.0]);
            let bays_per_m = (bays[1] - bays[0]) / length;
            let first = self.vertices.len();
            let corners = [(edge.start, bays[0]), (edge.end, bays[1])].map(|(point, bays)| {
                [building.base_m - FOUNDATION_M, building.roof_m].map(|height| {
                    let position = DVec3::new(point.x, point.y, height);
                    self.push(building, position, [bays, bays_per_m], origin)
                })
            });
            self.set_normals(first, normal);
            let [[a, d], [b, c]] = corners;
            self.indices.extend([a, b, c, a, c, d]);
        }
    }

    /// Gives the vertices from `first` on a packed normal.
    fn set_normals(&mut self, first: usize, normal: u32) {
        for vertex in &mut self.vertices[first..] {
            vertex.normal = normal;
        }
    }

    fn add_roof(&mut self, building: &Building, polygon: &Polygon<f64>, origin: DVec3) {
        let raw = polygon.earcut_triangles_raw();
        let first = self.vertices.len() as u32;
        for point in &raw.vertices {
            let position = DVec3::new(point[0], point[1], building.roof_m);
            self.push(building, position, [0.0; 2], origin);
        }
        self.set_normals(first as usize, pack_normal([0.0, 0.0, 1.0]));
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
