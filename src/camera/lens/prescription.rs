//! The prescription: surfaces from the front to the back, millimetres.

use super::{Coating, D_LINE_UM, Glass, LensError};

/// Most films of a coating and coefficients of an asphere.
const MAX_LAYERS: usize = 64;
const MAX_TERMS: usize = 20;
/// Smallest radius of a surface, millimetres.
const MIN_RADIUS_MM: f64 = 0.01;
/// Largest length in a lens, millimetres: a hundred metres.
const MAX_MM: f64 = 1e5;

/// One surface, or the stop.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Radius of curvature, positive when the centre lies behind the surface; 0 = plane.
    pub radius_mm: f64,
    /// Distance along the axis to the next surface (of the last one: to the sensor as the file has it).
    pub thickness_mm: f64,
    /// What comes after the surface.
    pub glass: Glass,
    /// Clear radius; none where the file gives none.
    pub semi_diameter_mm: Option<f64>,
    /// Conic constant: 0 sphere, -1 paraboloid.
    pub conic: f64,
    /// Coefficients of r², r⁴, r⁶ ... added to the conic's sag, 1/mm^(2k-1).
    pub aspheric: Vec<f64>,
    /// Anti-reflection coating; none = bare.
    pub coating: Option<Coating>,
}

/// A lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// Short name.
    pub name: String,
    /// Where the numbers come from.
    pub source: String,
    /// Surfaces from the front, the stop among them.
    pub surfaces: Vec<Surface>,
    /// Index of the stop in `surfaces`.
    pub stop: usize,
    /// Width and height of the film, millimetres.
    pub film_mm: [f64; 2],
}

impl Surface {
    /// A plane without glass: how a stop begins.
    pub fn plane(thickness_mm: f64) -> Self {
        Self {
            radius_mm: 0.0,
            thickness_mm,
            glass: Glass::Air,
            semi_diameter_mm: None,
            conic: 0.0,
            aspheric: Vec::new(),
            coating: None,
        }
    }

    /// 1 / radius at the vertex, with the asphere's r² term; 0 for a plane.
    pub fn curvature(&self) -> f64 {
        let base = if self.radius_mm == 0.0 {
            0.0
        } else {
            self.radius_mm.recip()
        };
        base + 2.0 * self.aspheric.first().copied().unwrap_or(0.0)
    }
}

impl Lens {
    /// Checks a table and fills clear radii that the file leaves out.
    ///
    /// # Errors
    /// `Unfit` when no light can go through: no surface, no stop, numbers that are none, a sensor in front of the lens.
    pub fn new(
        name: String,
        source: String,
        surfaces: Vec<Surface>,
        stop: Option<usize>,
        film_mm: [f64; 2],
    ) -> Result<Self, LensError> {
        let unfit = |what: String| LensError::Unfit {
            name: name.clone(),
            what,
        };
        let Some(stop) = stop else {
            return Err(unfit("no surface is the aperture stop; mark one".to_owned()));
        };
        if surfaces.len() < 2 || stop >= surfaces.len() {
            return Err(unfit("a lens needs a stop and at least one surface".to_owned()));
        }
        if surfaces.len() > 200 {
            return Err(unfit(format!(
                "{} surfaces are more than the 200 that are supported",
                surfaces.len()
            )));
        }
        if !film_mm.iter().all(|side| (0.1..=2000.0).contains(side)) {
            return Err(unfit(format!(
                "its film of {} x {} mm is none; give film_mm between 0.1 and 2000",
                film_mm[0], film_mm[1]
            )));
        }
        for (number, surface) in (1..).zip(&surfaces) {
            let layers = surface.coating.iter().flat_map(|coating| &coating.layers);
            let is_film = |layer: &super::Layer| {
                (0.5..10.0).contains(&layer.index) && (0.0..100.0).contains(&layer.thickness_um)
            };
            if !layers.clone().all(is_film) || layers.count() > MAX_LAYERS {
                return Err(unfit(format!(
                    "surface {number} has a coating of impossible films; give at most {MAX_LAYERS}, with indices between 0.5 and 10"
                )));
            }
            if surface.aspheric.len() > MAX_TERMS {
                return Err(unfit(format!(
                    "surface {number} has more than {MAX_TERMS} aspheric coefficients"
                )));
            }
            let sizes = [
                surface.semi_diameter_mm.unwrap_or(1.0),
                surface.thickness_mm.abs(),
            ];
            if sizes.iter().any(|size| *size > MAX_MM) {
                return Err(unfit(format!(
                    "surface {number} is larger or farther than {MAX_MM} mm; lengths are millimetres"
                )));
            }
            // 0 and infinity are a plane.
            if (f64::MIN_POSITIVE..MIN_RADIUS_MM).contains(&surface.radius_mm.abs()) {
                return Err(unfit(format!(
                    "surface {number} has a radius below {MIN_RADIUS_MM} mm; lengths are millimetres"
                )));
            }
            let numbers = [
                surface.radius_mm,
                surface.thickness_mm,
                surface.conic,
                surface.glass.index(D_LINE_UM),
            ];
            let clear = surface.semi_diameter_mm.unwrap_or(1.0);
            let mut values = numbers.iter().chain(&surface.aspheric).chain([&clear]);
            if values.any(|value| !value.is_finite()) || clear <= 0.0 {
                return Err(unfit(format!("surface {number} has a value that is no number")));
            }
            if !(0.5..5.0).contains(&surface.glass.index(D_LINE_UM)) {
                return Err(unfit(format!(
                    "surface {number} has the refractive index {}; an index lies between 1 and about 4",
                    surface.glass.index(D_LINE_UM)
                )));
            }
        }
        Ok(Self {
            name,
            source,
            surfaces,
            stop,
            film_mm,
        })
    }

    /// Indices of all media at a wavelength: before the first surface, then after each.
    pub fn indices(&self, wavelength_um: f64) -> Vec<f64> {
        std::iter::once(1.0)
            .chain(
                self.surfaces
                    .iter()
                    .map(|surface| surface.glass.index(wavelength_um)),
            )
            .collect()
    }

    /// Whether light is reflected at a surface: the media on its sides differ.
    pub fn reflects(&self, surface: usize) -> bool {
        let before = match surface {
            0 => 1.0,
            _ => self.surfaces[surface - 1].glass.index(D_LINE_UM),
        };
        (before - self.surfaces[surface].glass.index(D_LINE_UM)).abs() > 1e-9
    }

    /// Clear radius of a surface, millimetres; infinite where the file gives none.
    pub fn clear_radius(&self, surface: usize) -> f64 {
        self.surfaces[surface].semi_diameter_mm.unwrap_or(f64::INFINITY)
    }
}

/// Film of a full-frame camera, millimetres.
pub fn full_frame() -> [f64; 2] {
    [36.0, 24.0]
}

/// A radius, with infinity for a plane too.
pub fn plane_or(radius: f64) -> f64 {
    if radius.is_infinite() { 0.0 } else { radius }
}
