//! A building, or one vertex of it, that moves with the pointer.

use geo::{Coord, MapCoords, MultiPolygon};
use glam::{DVec2, DVec3};

use super::marks::pixel_of;
use crate::buildings::Building;
use crate::space::Projection;

/// What is held.
#[derive(Clone, Debug)]
pub struct Grab {
    outline: MultiPolygon<f64>,
    /// The vertex held; none for the whole.
    vertex: Option<Coord<f64>>,
    /// Elevation of the plane in which it moves: the roof's, metres.
    plane_m: f64,
    from: DVec2,
    to: DVec2,
}

/// A vertex is taken hold of within so many pixels.
const HANDLE_PIXELS: f64 = 9.0;

impl Grab {
    /// Takes hold of a building under a point of the image: of the vertex there, or of the whole. None where its roof's plane is not seen.
    pub fn begin(building: &Building, projection: &Projection, position: DVec2) -> Option<Self> {
        let from = on_plane(projection, position, building.roof_m)?;
        let rings = building
            .outline
            .iter()
            .flat_map(|polygon| std::iter::once(polygon.exterior()).chain(polygon.interiors()));
        let vertex = rings.flat_map(|ring| ring.coords()).find(|vertex| {
            let corner = DVec3::new(vertex.x, vertex.y, building.roof_m);
            pixel_of(projection, corner).is_some_and(|pixel| pixel.distance(position) <= HANDLE_PIXELS)
        });
        Some(Self {
            vertex: vertex.copied(),
            outline: building.outline.clone(),
            plane_m: building.roof_m,
            from,
            to: from,
        })
    }

    /// Follows the pointer.
    pub fn follow(&mut self, projection: &Projection, position: DVec2) {
        if let Some(to) = on_plane(projection, position, self.plane_m) {
            self.to = to;
        }
    }

    /// Whether it is a vertex that is held.
    pub fn is_vertex(&self) -> bool {
        self.vertex.is_some()
    }

    /// Whether it was moved at all.
    pub fn is_moved(&self) -> bool {
        self.to.distance(self.from) > 1e-3
    }

    /// The outline as it would be.
    pub fn outline(&self) -> MultiPolygon<f64> {
        let step = self.to - self.from;
        self.outline.map_coords(|at| {
            let moves = self.vertex.is_none_or(|vertex| vertex == at);
            match moves {
                true => Coord {
                    x: at.x + step.x,
                    y: at.y + step.y,
                },
                false => at,
            }
        })
    }

    /// Elevation of the roof that moves, metres.
    pub fn roof_m(&self) -> f64 {
        self.plane_m
    }
}

/// Where the ray through a point of the image meets a level plane; none behind the eye or towards the horizon.
fn on_plane(projection: &Projection, position: DVec2, elevation_m: f64) -> Option<DVec2> {
    let (eye, direction) = (projection.pose.eye, projection.direction_at(position));
    let t = (elevation_m - eye.z) / direction.z;
    (t.is_finite() && t > 0.0).then(|| (eye + t * direction).truncate())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{BuildingMaterial, FacadeStyle, RoofStyle};
    use crate::space::Pose;

    #[test]
    fn a_vertex_moves_alone_and_the_whole_together() {
        let ring = vec![(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)];
        let building = Building {
            fid: 1,
            outline: MultiPolygon::new(vec![geo::Polygon::new(ring.into(), Vec::new())]),
            base_m: 0.0,
            roof_m: 8.0,
            material: BuildingMaterial {
                facade: FacadeStyle::ALL[0].into(),
                has_shops: false,
                roof: RoofStyle::ALL[0],
                storeys: 2,
                direction: 0,
            },
        };
        let pose = Pose::looking_at(DVec3::new(5.0, -30.0, 60.0), DVec3::new(5.0, 5.0, 8.0));
        let projection = Projection::new(pose, [800, 600], 0.8);
        let pixel = |x: f64, y: f64| pixel_of(&projection, DVec3::new(x, y, 8.0)).unwrap_or_default();
        let moved = |from: [f64; 2], to: [f64; 2]| {
            let mut grab = Grab::begin(&building, &projection, pixel(from[0], from[1]))?;
            grab.follow(&projection, pixel(to[0], to[1]));
            let outline = grab.outline();
            Some(
                outline.0[0]
                    .exterior()
                    .0
                    .iter()
                    .map(|at| [at.x, at.y])
                    .collect::<Vec<_>>(),
            )
        };
        let is = |moved: Option<Vec<[f64; 2]>>, wanted: [[f64; 2]; 5]| {
            moved.is_some_and(|moved| {
                moved
                    .iter()
                    .zip(wanted)
                    .all(|(at, is)| (at[0] - is[0]).abs() < 1e-6 && (at[1] - is[1]).abs() < 1e-6)
            })
        };
        let corner = moved([10.0, 10.0], [13.0, 12.0]);
        assert!(is(
            corner,
            [[0.0, 0.0], [10.0, 0.0], [13.0, 12.0], [0.0, 10.0], [0.0, 0.0]]
        ));
        let whole = moved([5.0, 5.0], [6.0, 3.0]);
        assert!(is(
            whole,
            [[1.0, -2.0], [11.0, -2.0], [11.0, 8.0], [1.0, 8.0], [1.0, -2.0]]
        ));
    }
}
