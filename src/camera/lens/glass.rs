//! Refractive index by wavelength.

/// The helium d line, micrometres: the wavelength of n_d.
pub const D_LINE_UM: f64 = 0.587_561_8;
/// The hydrogen F line, micrometres.
const F_LINE_UM: f64 = 0.486_132_7;
/// The hydrogen C line, micrometres.
const C_LINE_UM: f64 = 0.656_272_5;

/// What fills the gap behind a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Glass {
    /// Air, index 1 (as prescriptions have it: all indices are relative to air).
    Air,
    /// A glass known by index and dispersion alone.
    Model {
        /// Index at the d line.
        n_d: f64,
        /// Abbe number (n_d - 1) / (n_F - n_C); infinite or 0 = no dispersion.
        v_d: f64,
    },
    /// A catalogue glass.
    Catalogue {
        /// Its name.
        name: String,
        /// Its equation.
        dispersion: Dispersion,
        /// Added to the index: the melt's n_d, where a prescription states it, less the catalogue's.
        offset: f64,
    },
}

/// A maker's equation for n².
#[derive(Clone, Debug, PartialEq)]
pub enum Dispersion {
    /// Sellmeier: n² = constant + Σ Bλ²/(λ² - C) (Schott TIE-29, section 2).
    Sellmeier {
        /// 1, or what stands for resonances far in the ultraviolet.
        constant: f64,
        /// B without unit, C in square micrometres.
        terms: Vec<[f64; 2]>,
    },
    /// Schott's older form, which Hoya, Hikari and Sumita use: n² = constant + Σ A λ^p, λ in micrometres.
    Powers {
        /// The term without a power.
        constant: f64,
        /// A and p.
        terms: Vec<[f64; 2]>,
    },
}

impl Dispersion {
    /// n² at a wavelength in micrometres.
    pub fn square(&self, wavelength_um: f64) -> f64 {
        let square = wavelength_um * wavelength_um;
        match self {
            Self::Sellmeier { constant, terms } => {
                let sum: f64 = terms.iter().map(|[b, c]| b * square / (square - c)).sum();
                constant + sum
            }
            Self::Powers { constant, terms } => {
                let sum: f64 = terms
                    .iter()
                    .map(|[a, power]| a * wavelength_um.powf(*power))
                    .sum();
                constant + sum
            }
        }
    }
}

impl Glass {
    /// The same dispersion through another index at the d line: a melt's.
    pub fn with_index(self, n_d: f64) -> Self {
        let offset = n_d - self.index(D_LINE_UM);
        match self {
            Self::Catalogue { name, dispersion, .. } => Self::Catalogue {
                name,
                dispersion,
                offset,
            },
            other => other,
        }
    }

    /// By index and dispersion; index 1 is air.
    pub fn model(n_d: f64, v_d: f64) -> Self {
        if (n_d - 1.0).abs() < 1e-9 {
            Self::Air
        } else {
            Self::Model { n_d, v_d }
        }
    }

    /// Index at a wavelength in micrometres, relative to air.
    ///
    /// Catalogue glasses by their maker's equation; others by Cauchy's two terms, n = A + B/λ², fitted to n_d and the Abbe
    /// number.
    pub fn index(&self, wavelength_um: f64) -> f64 {
        let square = wavelength_um * wavelength_um;
        match self {
            Self::Air => 1.0,
            Self::Model { n_d, v_d } => {
                if *v_d <= 0.0 || !v_d.is_finite() {
                    return *n_d;
                }
                let spread = 1.0 / (F_LINE_UM * F_LINE_UM) - 1.0 / (C_LINE_UM * C_LINE_UM);
                let slope = (n_d - 1.0) / (v_d * spread);
                n_d + slope * (1.0 / square - 1.0 / (D_LINE_UM * D_LINE_UM))
            }
            Self::Catalogue {
                dispersion, offset, ..
            } => dispersion.square(wavelength_um).sqrt() + offset,
        }
    }

    /// Abbe number (n_d - 1) / (n_F - n_C); infinite without dispersion.
    pub fn abbe_number(&self) -> f64 {
        let [d, f, c] = [D_LINE_UM, F_LINE_UM, C_LINE_UM].map(|line| self.index(line));
        (d - 1.0) / (f - c)
    }

    /// Whether it is a catalogue glass with this equation.
    pub fn is_by(&self, equation: &Dispersion) -> bool {
        matches!(self, Self::Catalogue { dispersion, .. } if dispersion == equation)
    }

    /// Name of a catalogue glass.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Catalogue { name, .. } => Some(name),
            _ => None,
        }
    }
}
