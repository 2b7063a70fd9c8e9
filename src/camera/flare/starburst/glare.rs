//! What lies farther from the light's image than the transform reaches: the spikes run on, and a veil of scattered light.
//!
//! **Spikes.** Far from the centre the power of the transform of an opening comes from its edges (Keller 1962; Goodman,
//! *Introduction to Fourier Optics*, section 4.3): an edge of length L of an opening of area A sends L λ f / (4 π² A a²) of the
//! light, per millimetre, to either side across itself, at a distance a on a sensor behind the focal length f; the light's disc makes
//! a band of that as wide as itself. An edge that is curved by the blades' rounding fans it out. A round opening sends λ N / (π³ r³)
//! per square millimetre everywhere, the envelope of Airy's pattern.
//!
//! **Veil.** Glass and barrel scatter; how much by the sine from the image is Harvey's law b = b₀ (1 + (β / l)²)^(s / 2) (Harvey 1976,
//! *Light-scattering characteristics of optical surfaces*). The whole of it, 0.5 % of the light, is an estimate: the veiling glare of
//! coated lenses is 1 to 3 % with their ghosts (ISO 9358).

use std::f64::consts::PI;

use glam::DVec2;
use rayon::prelude::*;

use super::StarburstOptics;
use crate::camera::flare::{Aperture, Wavelength};

/// Fraction of the light that is scattered.
const SCATTERED: f64 = 0.005;
/// Sine from the image where scattering begins to fall off, and the slope of its fall.
const SHOULDER: f64 = 0.005;
const SLOPE: f64 = -1.8;
/// Distance from which the spikes fade, by half the side of their image.
const FADE_FROM: f64 = 0.75;

/// Scattered part of the light per steradian, at a sine from its image.
fn veil(sine: f64) -> f64 {
    // The integral of b over the half space is SCATTERED.
    let whole = |sine: f64| ((1.0 + (sine / SHOULDER).powi(2)).powf(1.0 + 0.5 * SLOPE) - 1.0) / (2.0 + SLOPE);
    let centre = SCATTERED / (2.0 * PI * SHOULDER * SHOULDER * whole(1.0));
    centre * (1.0 + (sine / SHOULDER).powi(2)).powf(0.5 * SLOPE)
}

/// The spikes of an opening.
struct Spikes {
    /// Unit vectors, with how many edges send light there.
    directions: Vec<(DVec2, f64)>,
    /// Light per millimetre at 1 mm, by an edge and for a wavelength of 1 mm; of a round opening per square millimetre.
    strength: f64,
    /// Tangent of half the angle that rounded edges fan out.
    fan: f64,
    disc_mm: f64,
}

impl Spikes {
    /// Of a disc of light behind an opening.
    fn new(optics: &StarburstOptics) -> Self {
        let Aperture {
            blades,
            rounding,
            rotation,
            ..
        } = optics.aperture;
        let disc_mm = optics.angular_radius * optics.focal_mm;
        if blades < 3 {
            return Self {
                directions: Vec::new(),
                strength: optics.f_number / PI.powi(3),
                fan: 0.0,
                disc_mm,
            };
        }
        let half_sector = PI / f64::from(blades);
        // Of the polygon in the circle of radius 1.
        let edge = 2.0 * half_sector.sin();
        let area = 0.5 * f64::from(blades) * (2.0 * half_sector).sin();
        let across = |blade: u32| DVec2::from_angle(rotation + half_sector * f64::from(2 * blade + 1));
        let both = (0..blades).flat_map(|blade| [across(blade), -across(blade)]);
        let mut directions: Vec<(DVec2, f64)> = Vec::new();
        for direction in both {
            match directions
                .iter_mut()
                .find(|(known, _)| known.dot(direction) > 1.0 - 1e-9)
            {
                Some((_, edges)) => *edges += 1.0,
                None => directions.push((direction, 1.0)),
            }
        }
        Self {
            directions,
            strength: edge * 2.0 * optics.f_number / (4.0 * PI * PI * area),
            fan: (rounding * half_sector).tan(),
            disc_mm,
        }
    }

    /// Part of the light per square millimetre, at a place from the light's image, millimetres, for a wavelength in millimetres. Places
    /// on the disc have none.
    fn at(&self, place: DVec2, wavelength_mm: f64, texel_mm: f64) -> f64 {
        let width = self.disc_mm.max(0.5 * texel_mm);
        if self.directions.is_empty() {
            let r = place.length().max(width);
            return self.strength * wavelength_mm / r.powi(3);
        }
        // Part of the disc on the one side of a line across it.
        let side = |b: f64| {
            let t = (b / width).clamp(-1.0, 1.0);
            0.5 + (t * (1.0 - t * t).sqrt() + t.asin()) / PI
        };
        let spike = |(direction, edges): &(DVec2, f64)| {
            let along = place.dot(*direction);
            let aside = place.perp_dot(*direction);
            if along < width {
                return 0.0;
            }
            let half_fan = (self.fan * along).max(0.05 * width);
            let profile = (side(aside + half_fan) - side(aside - half_fan)) / (2.0 * half_fan);
            edges * profile / (along * along)
        };
        self.strength * wavelength_mm * self.directions.iter().map(spike).sum::<f64>()
    }
}

/// Part that is left of the spikes at a distance, by half the side of their image: they end without an edge.
fn fade(distance: f64) -> f64 {
    let t = ((1.0 - distance) / (1.0 - FADE_FROM)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A square image round the light's: columns and rows, and half its side, millimetres.
#[derive(Clone, Copy, Debug)]
pub struct GlareImage {
    /// Columns and rows.
    pub size: usize,
    /// Millimetres.
    pub half_mm: f64,
}

impl GlareImage {
    /// Values by the place from the light's image, millimetres, rows from the top.
    fn drawn(self, value: impl Fn(DVec2) -> [f32; 3] + Sync) -> Vec<[f32; 3]> {
        let Self { size, half_mm } = self;
        let place = |k: usize| {
            DVec2::new((k % size) as f64 + 0.5, (size - 1 - k / size) as f64 + 0.5) * self.texel_mm()
                - half_mm
        };
        (0..size * size)
            .into_par_iter()
            .map(|k| value(place(k)))
            .collect()
    }

    fn texel_mm(self) -> f64 {
        2.0 * self.half_mm / self.size as f64
    }
}

/// The spikes as radiance for a light of irradiance 1. They begin where `shown`, the part of the transform that is shown at a distance,
/// falls from 1.
pub fn far_spikes(
    optics: &StarburstOptics,
    colours: &[Wavelength],
    image: GlareImage,
    shown: impl Fn(f64) -> f64 + Sync,
) -> Vec<[f32; 3]> {
    let spikes = Spikes::new(optics);
    // Power in the spikes goes with the wavelength: one mean for each channel.
    let mean_mm = [0, 1, 2].map(|channel: usize| {
        let parts = colours.iter().map(|colour| colour.rgb[channel] * colour.um);
        1e-3 * parts.sum::<f64>()
    });
    let square = optics.focal_mm * optics.focal_mm;
    image.drawn(|place| {
        let r = place.length();
        let part = (1.0 - shown(r)) * fade(r / image.half_mm);
        if part <= 0.0 {
            return [0.0; 3];
        }
        let spike = square * part * spikes.at(place, 1.0, image.texel_mm());
        mean_mm.map(|wavelength_mm| (spike * wavelength_mm) as f32)
    })
}

/// The veil as radiance for a light of irradiance 1.
pub fn veil_image(focal_mm: f64, image: GlareImage) -> Vec<[f32; 3]> {
    image.drawn(|place| [veil((place.length() / focal_mm).atan().sin()) as f32; 3])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All of the veil is what is said.
    #[test]
    fn the_veil_holds_its_fraction() {
        let steps = 200_000;
        let sum: f64 = (0..steps)
            .map(|k| {
                let sine = (f64::from(k) + 0.5) / f64::from(steps);
                2.0 * PI * sine * veil(sine) / f64::from(steps)
            })
            .sum();
        assert!((sum / SCATTERED - 1.0).abs() < 1e-3, "{sum}");
    }
}
