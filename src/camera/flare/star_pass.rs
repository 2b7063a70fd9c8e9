//! Adds the sun's starburst to a picture.

use glam::DVec2;

use super::{Aperture, Diffraction, Sprite, Wavelength, encode_sprite};
use crate::gpu::{Gpu, Target};

/// How many pupil diameters the aperture's mask spans: two, so that the power, whose frequencies are twice the amplitude's, is
/// sampled finely enough.
const MASK_REACH: f64 = 2.0;
/// Pattern's side by the transform's.
const PATTERN_SHARE: usize = 4;

/// A source's sharp image and where it stands.
#[derive(Clone, Copy, Debug)]
pub struct Star {
    /// On the sensor, millimetres, x right and y up.
    pub at_mm: [f64; 2],
    /// Radius of its sharp image, millimetres.
    pub disc_mm: f64,
    /// Focal length, millimetres.
    pub focal_mm: f64,
    /// f-number.
    pub f_number: f64,
    /// Irradiance on a surface facing it, linear sRGB, already times its visible share.
    pub irradiance: [f64; 3],
    /// Side of the aperture's mask for the transform, texels.
    pub mask_side: usize,
}

/// Adds the image of a disc with its diffraction to `target`, whose picture spans `half_mm` to each side. The whole light of
/// the source falls on the sensor as irradiance times f² per solid angle: radiance = irradiance · f² · spread.
pub fn encode_starburst(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    target: &Target,
    star: &Star,
    aperture: &Aperture,
    colours: &[Wavelength],
    half_mm: [f64; 2],
) {
    let diffraction = Diffraction::from_aperture(aperture, star.mask_side, MASK_REACH);
    // All of the transform's bins in the centre of the spectrum.
    let span_mm = 0.5 * star.mask_side as f64 * diffraction.bin_mm(0.5, star.f_number);
    let side = star.mask_side / PATTERN_SHARE;
    let spread = diffraction.spread(colours, star.f_number, star.disc_mm, side, span_mm);
    let most = spread
        .iter()
        .flatten()
        .fold(f32::MIN_POSITIVE, |most, &value| most.max(value));
    // Half floats hold five digits: the pattern goes up to 1, its scale into the factor. Its rows run from below.
    let rows = spread.chunks_exact(side).rev().flatten();
    let texels: Vec<[f32; 3]> = rows.map(|rgb| [0, 1, 2].map(|k: usize| rgb[k] / most)).collect();
    let scale = star.focal_mm * star.focal_mm * f64::from(most);
    let sprite = Sprite {
        texels: &texels,
        size: [side as u32; 2],
        centre_mm: DVec2::from_array(star.at_mm),
        half_mm: DVec2::splat(span_mm),
        turn: 0.0,
        radiance: star.irradiance.map(|channel| channel * scale),
    };
    encode_sprite(gpu, encoder, target, &sprite, half_mm);
}
