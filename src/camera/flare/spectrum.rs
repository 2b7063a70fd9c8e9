//! Wavelengths that ghosts are drawn in, and what each adds to linear sRGB.

/// One of them.
#[derive(Clone, Copy, Debug)]
pub struct Wavelength {
    /// Micrometres.
    pub um: f64,
    /// Fraction of each linear sRGB channel; all fractions of a spectrum add up to 1, 1, 1.
    pub rgb: [f64; 3],
}

/// `count` wavelengths: three are 650, 510 and 475 nm, one a channel (Lee & Eisemann 2013, section 4); more spread over the
/// visible range by the eye's colour matching functions.
pub fn spectrum(count: usize) -> Vec<Wavelength> {
    if count <= 3 {
        return [
            (0.650, [1.0, 0.0, 0.0]),
            (0.510, [0.0, 1.0, 0.0]),
            (0.475, [0.0, 0.0, 1.0]),
        ]
        .map(|(um, rgb)| Wavelength { um, rgb })
        .to_vec();
    }
    let (from, to) = (0.410, 0.680);
    let mut all: Vec<Wavelength> = (0..count)
        .map(|k| {
            let um = from + (to - from) * (k as f64 + 0.5) / count as f64;
            Wavelength {
                um,
                rgb: linear_srgb(um * 1e3),
            }
        })
        .collect();
    for channel in 0..3 {
        let sum: f64 = all.iter().map(|one| one.rgb[channel]).sum();
        all.iter_mut().for_each(|one| one.rgb[channel] /= sum);
    }
    all
}

/// Linear sRGB of light of one wavelength in nanometres: CIE 1931 by the sums of Gaussians of Wyman, Sloan & Shirley
/// (2013, JCGT 2(2), listing 1), then IEC 61966-2-1's matrix; what lies outside the gamut is cut at 0.
fn linear_srgb(nm: f64) -> [f64; 3] {
    let lobe = |height: f64, centre: f64, below: f64, above: f64| {
        let t = (nm - centre) * if nm < centre { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    let x = lobe(0.362, 442.0, 0.0624, 0.0374)
        + lobe(1.056, 599.8, 0.0264, 0.0323)
        + lobe(-0.065, 501.1, 0.0490, 0.0382);
    let y = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322);
    let z = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725);
    [
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    ]
    .map(|channel| channel.max(0.0))
}
