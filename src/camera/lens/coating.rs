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
    let start = |y2: f64| (Complex64::from(1.0), Complex64::from(y2));
    let mut fields = [start(n2 * cos2), start(n2 / cos2.max(1e-12))];
    // Product of the films' matrices [[cos d, i sin d / y], [i y sin d, cos d]] applied to (1, y2).
    for layer in layers.iter().rev() {
        let square = 1.0 - (invariant / layer.index).powi(2);
        let thickness = std::f64::consts::TAU * layer.index * layer.thickness_um / wavelength_um;
        // Beyond a film's own limit of total reflection its cosine is imaginary, and the wave in it fades.
        let (cos, sin_d, cos_d) = if square > 0.0 {
            let (sin_d, cos_d) = (thickness * square.sqrt()).sin_cos();
            (Complex64::from(square.sqrt()), Complex64::from(sin_d), cos_d)
        } else {
            let cos = (-square).max(1e-12).sqrt();
            let depth = thickness * cos;
            (Complex64::i() * cos, Complex64::i() * depth.sinh(), depth.cosh())
        };
        let admittances = [cos * layer.index, layer.index / cos];
        for ((e, h), y) in fields.iter_mut().zip(admittances) {
            let across = Complex64::i() * sin_d;
            (*e, *h) = (*e * cos_d + across / y * *h, across * y * *e + *h * cos_d);
        }
    }
    let power = |(e, h): (Complex64, Complex64), y1: f64| ((e * y1 - h) / (e * y1 + h)).norm_sqr();
    0.5 * (power(fields[0], n1 * cos1) + power(fields[1], n1 / cos1.max(1e-12)))
}
