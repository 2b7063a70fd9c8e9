//! Reflectance of a coated surface by the characteristic matrix of its layers.
//!
//! Born & Wolf, *Principles of Optics*, 7th ed., section 1.6.2-1.6.4 (dielectric films); the case without a layer is
//! Fresnel's equations (1.5.2).

use num_complex::Complex64;

/// One film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Refractive index.
    pub index: f64,
    /// Thickness, micrometres.
    pub thickness_um: f64,
}

/// A stack of films, the outermost (towards the front of the lens) first.
#[derive(Clone, Debug, PartialEq)]
pub struct Coating {
    /// The films.
    pub layers: Vec<Layer>,
}

impl Coating {
    /// A single film a quarter wave thick at a wavelength in micrometres.
    pub fn quarter_wave(wavelength_um: f64, index: f64) -> Self {
        Self {
            layers: vec![Layer {
                index,
                thickness_um: wavelength_um / (4.0 * index),
            }],
        }
    }
}

/// Share of unpolarised power that is reflected where light in a medium of index `n1` meets `layers` on a medium of
/// index `n2`, at `cos_incidence` to the normal. `layers` are in the order that the light meets them; 1 for total
/// reflection.
pub fn reflectance(n1: f64, layers: &[Layer], n2: f64, cos_incidence: f64, wavelength_um: f64) -> f64 {
    let cos1 = cos_incidence.abs().min(1.0);
    // Snell's invariant n sin(angle).
    let invariant = n1 * (1.0 - cos1 * cos1).max(0.0).sqrt();
    let cosine = |n: f64| (1.0 - (invariant / n).powi(2)).max(0.0).sqrt();
    if invariant >= n2 {
        return 1.0;
    }
    let cos2 = cosine(n2);
    // Admittance of a medium: n cos for the s, n / cos for the p polarisation (Born & Wolf 1.6 eq. 55, 59).
    let power = |s: bool| {
        let admittance = |n: f64, cos: f64| if s { n * cos } else { n / cos.max(1e-12) };
        let (y1, y2) = (admittance(n1, cos1), admittance(n2, cos2));
        // Product of the films' matrices [[cos d, i sin d / y], [i y sin d, cos d]] applied to (1, y2).
        let (mut e, mut h) = (Complex64::from(1.0), Complex64::from(y2));
        for layer in layers.iter().rev() {
            let cos = cosine(layer.index);
            let y = admittance(layer.index, cos);
            let phase = std::f64::consts::TAU * layer.index * layer.thickness_um * cos / wavelength_um;
            let (sin_d, cos_d) = phase.sin_cos();
            (e, h) = (
                e * cos_d + Complex64::i() * (sin_d / y) * h,
                Complex64::i() * (y * sin_d) * e + h * cos_d,
            );
        }
        ((e * y1 - h) / (e * y1 + h)).norm_sqr()
    };
    0.5 * (power(true) + power(false))
}
