//! Exact rays through a lens, surface after surface, f64.
//!
//! Welford, *Aberrations of Optical Systems* (1986), section 4.3-4.7: transfer to the vertex plane, the conic by its
//! quadratic in the stable form, aspheres by Newton steps from there; Snell's law in vector form. The ray is taken through
//! every surface also where it misses the clear aperture; what it missed by is told.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::lens::{Layer, Lens, Surface, reflectance};
use super::path::{Ghost, Step, path};

/// A lens made ready for many rays of one wavelength.
#[derive(Clone, Debug)]
pub struct Tracer<'a> {
    lens: &'a Lens,
    indices: Vec<f64>,
    /// Each surface's films as light meets them from the front, and from behind.
    films: Vec<[Vec<Layer>; 2]>,
    wavelength_um: f64,
    sensor_gap_mm: f64,
}

/// Where a ray went.
#[derive(Clone, Copy, Debug)]
pub struct TracedRay {
    /// In the plane of the stop, at its first crossing, millimetres.
    pub stop_mm: DVec2,
    /// On the sensor, millimetres.
    pub sensor_mm: DVec2,
    /// Largest ratio of the ray's height to a surface's clear radius on the way, the stop apart; over 1 the lens barrel
    /// stops it.
    pub relative_height: f64,
    /// Largest ratio of its height to the stop's clear radius.
    pub relative_stop: f64,
    /// Fraction of its power that arrives (Fresnel and coatings).
    pub power: f64,
}

impl TracedRay {
    /// Whether it passes every clear aperture and the open stop.
    pub fn is_alive(&self) -> bool {
        self.relative_height <= 1.0 && self.relative_stop <= 1.0
    }
}

/// A collimated beam's direction at an angle from the axis in the x-z plane, radians.
pub fn beam_direction(angle: f64) -> DVec3 {
    DVec3::new(angle.sin(), 0.0, angle.cos())
}

impl<'a> Tracer<'a> {
    /// For a wavelength in micrometres and a sensor behind the last vertex.
    pub fn new(lens: &'a Lens, wavelength_um: f64, sensor_gap_mm: f64) -> Self {
        Self {
            lens,
            indices: lens.indices(wavelength_um),
            films: lens
                .surfaces
                .iter()
                .map(|surface| {
                    let front: Vec<Layer> = surface
                        .coating
                        .as_ref()
                        .map_or_else(Vec::new, |coating| coating.layers.clone());
                    let behind = front.iter().rev().copied().collect();
                    [front, behind]
                })
                .collect(),
            wavelength_um,
            sensor_gap_mm,
        }
    }

    /// Follows a ray from `entry_mm` on the plane of the first vertex along a unit `direction`; none when it misses a
    /// surface or is reflected totally where it should pass.
    pub fn trace(&self, ghost: Option<Ghost>, entry_mm: DVec2, direction: DVec3) -> Option<TracedRay> {
        self.follow(ghost, entry_mm, direction, |_| {})
    }

    /// As `trace`, with where each surface is met, in the coordinates of its vertex.
    pub fn trace_points(
        &self,
        ghost: Option<Ghost>,
        entry_mm: DVec2,
        direction: DVec3,
    ) -> Option<(TracedRay, Vec<DVec3>)> {
        let mut points = Vec::new();
        let ray = self.follow(ghost, entry_mm, direction, |at| points.push(at))?;
        Some((ray, points))
    }

    fn follow(
        &self,
        ghost: Option<Ghost>,
        entry_mm: DVec2,
        direction: DVec3,
        mut meets: impl FnMut(DVec3),
    ) -> Option<TracedRay> {
        let surfaces = &self.lens.surfaces;
        let mut at = entry_mm.extend(0.0);
        let mut d = direction;
        let mut stop = None;
        let (mut relative_height, mut relative_stop, mut power) = (0.0_f64, 0.0_f64, 1.0);
        let mut before: Option<usize> = None;
        for step in path(surfaces.len(), ghost) {
            // Coordinates are those of the surface's own vertex.
            if let Some(before) = before {
                at.z += if step.surface > before {
                    -surfaces[before].thickness_mm
                } else {
                    surfaces[step.surface].thickness_mm
                };
            }
            let surface = &surfaces[step.surface];
            at = meet(surface, at, d)?;
            meets(at);
            let height = at.xy().length() / self.lens.clear_radius(step.surface);
            if step.surface == self.lens.stop {
                stop = stop.or(Some(at.xy()));
                relative_stop = relative_stop.max(height);
            } else {
                relative_height = relative_height.max(height);
            }
            let (front, behind) = (self.indices[step.surface], self.indices[step.surface + 1]);
            let (n1, n2) = if step.forward {
                (front, behind)
            } else {
                (behind, front)
            };
            let normal = normal_at(surface, at);
            let reflected = self.reflectance(step, n1, n2, normal.dot(d).abs());
            if step.reflects {
                d -= 2.0 * normal.dot(d) * normal;
                power *= reflected;
            } else {
                d = refract(d, normal, n1 / n2)?;
                power *= 1.0 - reflected;
            }
            before = Some(step.surface);
        }
        at.z -= self.sensor_gap_mm;
        let sensor = at - d * (at.z / d.z);
        Some(TracedRay {
            stop_mm: stop?,
            sensor_mm: sensor.xy(),
            relative_height,
            relative_stop,
            power,
        })
    }

    fn reflectance(&self, step: Step, n1: f64, n2: f64, cos: f64) -> f64 {
        if (n1 - n2).abs() < 1e-12 {
            return 0.0;
        }
        let films = &self.films[step.surface][usize::from(!step.forward)];
        reflectance(n1, films, n2, cos, self.wavelength_um)
    }
}

/// Steps of a ray towards an asphere, at most; and the one, millimetres, at which it is met.
const MAX_NEWTON_STEPS: u32 = 50;
const NEWTON_STEP_MM: f64 = 1e-11;

/// Where a ray meets a surface, in the vertex's coordinates; behind the start too, as sequential tracing has it.
fn meet(surface: &Surface, start: DVec3, d: DVec3) -> Option<DVec3> {
    if d.z == 0.0 {
        return None;
    }
    let on_plane = start - d * (start.z / d.z);
    if surface.radius_mm == 0.0 && surface.aspheric.is_empty() {
        return Some(on_plane);
    }
    let c = if surface.radius_mm == 0.0 {
        0.0
    } else {
        surface.radius_mm.recip()
    };
    // c (1 + k N²) s² - 2 g s + f = 0 for the distance s from the vertex plane (N = d.z), the root near the vertex.
    let f = c * on_plane.xy().length_squared();
    let g = d.z - c * on_plane.xy().dot(d.xy());
    let square = g * g - c * f * (1.0 + surface.conic * d.z * d.z);
    let on_conic = (square >= 0.0).then(|| on_plane + d * (f / (g + square.sqrt().copysign(d.z))));
    if surface.aspheric.is_empty() {
        return on_conic.filter(|at| at.is_finite());
    }
    // An asphere may be met where its conic alone is missed.
    let mut at = on_conic.unwrap_or(on_plane);
    for _ in 0..MAX_NEWTON_STEPS {
        let (sag, _) = sag_and_slope(surface, at.xy())?;
        let normal = normal_at(surface, at);
        // Newton: the height over the surface, over its change along the ray.
        let step = (at.z - sag) * normal.z / normal.dot(d);
        at -= d * step;
        if step.abs() < NEWTON_STEP_MM {
            return at.is_finite().then_some(at);
        }
    }
    None
}

impl Surface {
    /// Height of the surface over its vertex plane at a distance from the axis, millimetres; at the rim beyond it.
    pub fn sag(&self, r_mm: f64) -> f64 {
        let at = DVec2::new(r_mm, 0.0);
        sag_and_slope(self, at).map_or(self.radius_mm, |(sag, _)| sag)
    }
}

/// Sag z(r) = c r² / (1 + √(1 - (1 + k) c² r²)) + Σ aᵢ r^(2i), and dz/d(r²) times two (so that the gradient is it times x, y).
fn sag_and_slope(surface: &Surface, at: DVec2) -> Option<(f64, f64)> {
    let c = if surface.radius_mm == 0.0 {
        0.0
    } else {
        surface.radius_mm.recip()
    };
    let square = at.length_squared();
    let inside = 1.0 - (1.0 + surface.conic) * c * c * square;
    if inside <= 0.0 {
        return None;
    }
    let root = inside.sqrt();
    let (mut sag, mut slope) = (c * square / (1.0 + root), c / root);
    let mut power = 1.0;
    for (order, coefficient) in (1..).zip(&surface.aspheric) {
        slope += 2.0 * f64::from(order) * coefficient * power;
        power *= square;
        sag += coefficient * power;
    }
    Some((sag, slope))
}

/// Unit normal, towards +z at the vertex.
fn normal_at(surface: &Surface, at: DVec3) -> DVec3 {
    if surface.aspheric.is_empty() {
        if surface.radius_mm == 0.0 {
            return DVec3::Z;
        }
        // Gradient of the conic's equation: exact on all of it.
        let c = surface.radius_mm.recip();
        return DVec3::new(-c * at.x, -c * at.y, 1.0 - c * (1.0 + surface.conic) * at.z).normalize();
    }
    let slope = sag_and_slope(surface, at.xy()).map_or(0.0, |(_, slope)| slope);
    DVec3::new(-slope * at.x, -slope * at.y, 1.0).normalize()
}

/// Snell's law; none for total reflection. `ratio` is the index before over the index after.
fn refract(d: DVec3, normal: DVec3, ratio: f64) -> Option<DVec3> {
    let cos = normal.dot(d);
    let square = 1.0 - ratio * ratio * (1.0 - cos * cos);
    if square < 0.0 {
        return None;
    }
    Some(ratio * d + (square.sqrt().copysign(cos) - ratio * cos) * normal)
}
