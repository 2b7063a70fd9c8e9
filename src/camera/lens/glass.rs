//! Refractive index by wavelength.

use super::catalogue;

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
    Sellmeier {
        /// Its name.
        name: String,
        /// B1, B2, B3 (no unit).
        b: [f64; 3],
        /// C1, C2, C3, square micrometres.
        c: [f64; 3],
        /// Added to the index: the melt's n_d, where a prescription states it, less the catalogue's.
        offset: f64,
    },
}

impl Glass {
    /// By name, with the catalogue's index.
    pub fn catalogue(name: &str) -> Option<Self> {
        let &(name, _, b, c) = catalogue::find(name)?;
        Some(Self::Sellmeier {
            name: name.to_owned(),
            b,
            c,
            offset: 0.0,
        })
    }

    /// A named glass of stated index: where the catalogue knows it, its dispersion through the stated n_d; else by index
    /// and dispersion alone.
    pub fn named(name: &str, n_d: f64, v_d: f64) -> Self {
        match Self::catalogue(name) {
            Some(glass) if (glass.index(D_LINE_UM) - n_d).abs() < 1e-3 => glass.with_index(n_d),
            _ => Self::model(n_d, v_d),
        }
    }

    fn with_index(self, n_d: f64) -> Self {
        let offset = n_d - self.index(D_LINE_UM);
        match self {
            Self::Sellmeier { name, b, c, .. } => Self::Sellmeier { name, b, c, offset },
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
    /// Catalogue glasses by Sellmeier's equation, n² = 1 + Σ Bᵢλ²/(λ² - Cᵢ) (Schott TIE-29, section 2); others by
    /// Cauchy's two terms, n = A + B/λ², fitted to n_d and the Abbe number.
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
            Self::Sellmeier { b, c, offset, .. } => {
                let sum: f64 = b.iter().zip(c).map(|(b, c)| b * square / (square - c)).sum();
                (1.0 + sum).sqrt() + offset
            }
        }
    }

    /// Abbe number (n_d - 1) / (n_F - n_C); infinite without dispersion.
    pub fn abbe_number(&self) -> f64 {
        let [d, f, c] = [D_LINE_UM, F_LINE_UM, C_LINE_UM].map(|line| self.index(line));
        (d - 1.0) / (f - c)
    }

    /// Name of a catalogue glass.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Sellmeier { name, .. } => Some(name),
            _ => None,
        }
    }
}
