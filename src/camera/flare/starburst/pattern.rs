//! The image of a disc of light with its diffraction, ready to be laid where the light's image is.

use super::diffraction::{Diffraction, shown};
use super::glare::{GlareImage, far_spikes, veil_image};
use crate::camera::flare::{Aperture, spectrum};

/// How many pupil diameters the aperture's mask spans: two, so that the power, whose frequencies are twice the amplitude's, is
/// sampled finely enough.
const MASK_EXTENT: f64 = 2.0;
/// The transform's size by the pattern's.
const TRANSFORM_BY_PATTERN: usize = 4;

/// How finely a starburst is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StarburstParameters {
    /// Wavelengths.
    pub wavelengths: usize,
    /// Size of the transform; the starburst is drawn the farther the larger it is.
    pub transform_size: usize,
    /// Whether the sharp image of the light is in it; else what it lights has it, cut by what covers it.
    pub with_disc: bool,
}

/// What the lens does to a disc of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StarburstOptics {
    /// The iris.
    pub aperture: Aperture,
    /// f-number.
    pub f_number: f64,
    /// Focal length, millimetres.
    pub focal_mm: f64,
    /// Radius of the disc, radians.
    pub angular_radius: f64,
}

/// Half the side of the glare's image at least, by the focal length: 40 degrees to each side.
const GLARE_TANGENT: f64 = 0.85;
/// The same at most, millimetres: the diagonal of full frame.
const GLARE_MM: f64 = 43.3;
/// Columns and rows of the glare's image, by the transform's.
const TRANSFORM_BY_GLARE: usize = 4;

/// Square images around the light's.
pub struct StarburstPattern {
    /// Columns and rows.
    pub size: usize,
    /// Half its side on the sensor, millimetres.
    pub half_mm: f64,
    /// Columns and rows of the glare: the spikes beyond the pattern, and what is scattered.
    pub glare_size: usize,
    /// Half its side, millimetres.
    pub glare_half_mm: f64,
    /// The spikes' radiance as `radiance`.
    pub spikes: Vec<[f32; 3]>,
    /// That of what is scattered: it depends on how much light there is and not on the size of its disc.
    pub veil: Vec<[f32; 3]>,
    /// Part of the light that its sharp image keeps, by channel, where that is not in the pattern; else 0.
    pub disc_fraction: [f64; 3],
    /// Radiance for a light of irradiance 1, linear sRGB, rows from the top. The whole light of the source falls on the
    /// sensor as irradiance times f² per solid angle: radiance = irradiance · f² · spread.
    pub radiance: Vec<[f32; 3]>,
}

impl StarburstPattern {
    /// Transforms the aperture.
    pub fn new(optics: &StarburstOptics, parameters: StarburstParameters) -> Self {
        let transform_size = parameters.transform_size;
        let diffraction = Diffraction::from_aperture(&optics.aperture, transform_size, MASK_EXTENT);
        // All of the transform's bins in the centre of the spectrum.
        let half_mm = 0.5 * transform_size as f64 * diffraction.bin_mm(0.5, optics.f_number);
        let size = transform_size / TRANSFORM_BY_PATTERN;
        let colours = spectrum(parameters.wavelengths);
        let disc_mm = optics.angular_radius * optics.focal_mm;
        let image = (size, half_mm);
        let (spread, disc_fraction) =
            diffraction.spread(&colours, optics.f_number, disc_mm, image, parameters.with_disc);
        let glare_half_mm = GLARE_MM.max(GLARE_TANGENT * optics.focal_mm).min(2.0 * GLARE_MM);
        let glare = GlareImage {
            size: (transform_size / TRANSFORM_BY_GLARE).max(256),
            half_mm: glare_half_mm,
        };
        let shown = |r: f64| shown(r / half_mm);
        let square = (optics.focal_mm * optics.focal_mm) as f32;
        // Its rows run from below.
        let rows = spread.chunks_exact(size).rev().flatten();
        Self {
            size,
            half_mm,
            glare_size: glare.size,
            glare_half_mm,
            spikes: far_spikes(optics, &colours, glare, shown),
            veil: veil_image(optics.focal_mm, glare),
            disc_fraction,
            radiance: rows.map(|rgb| rgb.map(|value| value * square)).collect(),
        }
    }
}
