//! A building's base and roof from its footprint and the ground.

use geo::{BoundingRect, CoordsIter, MultiPolygon};

use crate::material::{BuildingMaterial, FacadeRules};
use crate::source::{Footprint, RoofSpec};
use crate::space::Bounds;

/// A footprint that stands on the ground: everything the building map needs.
#[derive(Clone, Debug)]
pub struct Building {
    /// Id in the footprint dataset of record.
    pub fid: u32,
    /// Outline in the city's CRS, metres; the building is to the left of every ring.
    pub outline: MultiPolygon<f64>,
    /// Lowest ground at the outline's vertices, metres.
    pub base_m: f64,
    /// Elevation of the flat roof, metres.
    pub roof_m: f64,
    /// What it is made of.
    pub material: BuildingMaterial,
}

/// The footprint has no ground under any vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoGround;

impl Building {
    /// Rectangle of the outline.
    pub fn bounds(&self) -> Bounds {
        self.outline.bounding_rect().map_or(Bounds::EMPTY, |rect| Bounds {
            west: rect.min().x,
            south: rect.min().y,
            east: rect.max().x,
            north: rect.max().y,
        })
    }

    /// Stands the footprint on its base and gives it a material. True beside it when part of the outline lies over missing ground.
    pub fn on_ground(
        footprint: Footprint,
        rules: &FacadeRules,
        ground: impl Fn(f64, f64) -> Option<f64>,
    ) -> Result<(Self, bool), NoGround> {
        let (base_m, partly_missing) = base_of(&footprint.outline, ground).ok_or(NoGround)?;
        let roof_m = match footprint.roof {
            RoofSpec::HeightAboveBase(height_m) => base_m + height_m,
            RoofSpec::Elevation(roof_m) => roof_m,
        };
        let material = rules.material(
            footprint.fid,
            &footprint.outline,
            roof_m - base_m,
            &footprint.traits,
        );
        let building = Self {
            fid: footprint.fid,
            outline: footprint.outline,
            base_m,
            roof_m,
            material,
        };
        Ok((building, partly_missing))
    }
}

/// Lowest ground at the outline's vertices, and whether some vertex has none. None when all have none.
pub fn base_of(outline: &MultiPolygon<f64>, ground: impl Fn(f64, f64) -> Option<f64>) -> Option<(f64, bool)> {
    let mut lowest: Option<f64> = None;
    let mut missing = false;
    for point in outline.coords_iter() {
        match ground(point.x, point.y) {
            Some(height) => lowest = Some(lowest.map_or(height, |low| low.min(height))),
            None => missing = true,
        }
    }
    lowest.map(|base| (base, missing))
}

/// Bytes of the outline raised as indexed triangles, the way city models are stored: four vertices a wall, one a
/// roof corner (position 12, normal 4, id 4 bytes), two triangles a wall, n - 2 + 2 holes a roof (12 bytes each).
pub fn triangle_bytes(outline: &MultiPolygon<f64>) -> u64 {
    let mut bytes = 0;
    for polygon in outline {
        let rings = std::iter::once(polygon.exterior()).chain(polygon.interiors());
        let corners: u64 = rings.map(|ring| ring.0.len().saturating_sub(1) as u64).sum();
        let holes = polygon.interiors().len() as u64;
        let triangles = 2 * corners + (corners + 2 * holes).saturating_sub(2);
        bytes += 5 * corners * 20 + triangles * 12;
    }
    bytes
}
