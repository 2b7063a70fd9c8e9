//! What a flare may cost: one table.

use super::{Blend, Fit, FlareMode, GhostParameters, Pattern, StarburstParameters, TracingDevice};

/// Names of the table's rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Quality {
    /// Quads in three colours.
    Low,
    /// Traced where ghosts are not linear, in three colours.
    Medium,
    /// The same with colour fringes.
    High,
    /// Every ghost traced.
    Ultra,
}

/// A row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// How ghosts are made.
    pub mode: FlareMode,
    /// Wavelengths of ghosts.
    pub wavelengths: usize,
    /// Rays along an edge of a traced ghost's grid.
    pub rays: usize,
    /// Wavelengths of the starburst.
    pub starburst_wavelengths: usize,
    /// Side of its transform; the starburst is drawn the farther the larger it is.
    pub transform_size: usize,
}

const fn preset(mode: FlareMode, numbers: [usize; 4]) -> Preset {
    let [wavelengths, rays, starburst_wavelengths, transform_size] = numbers;
    Preset {
        mode,
        wavelengths,
        rays,
        starburst_wavelengths,
        transform_size,
    }
}

impl Preset {
    /// All ghosts, on the GPU.
    pub fn ghosts(self) -> GhostParameters {
        GhostParameters {
            mode: self.mode,
            wavelengths: self.wavelengths,
            rays: self.rays,
            only: None,
            pattern: Pattern::Whole,
            photographed: false,
            blend: Blend::Add,
            fit: Fit::default(),
            whole_entrance: false,
            tracing: TracingDevice::Gpu,
        }
    }

    /// The starburst.
    pub fn starburst(self) -> StarburstParameters {
        StarburstParameters {
            wavelengths: self.starburst_wavelengths,
            transform_size: self.transform_size,
            with_disc: false,
        }
    }
}

impl Quality {
    /// Its row.
    pub const fn preset(self) -> Preset {
        match self {
            Self::Low => preset(FlareMode::Paraxial, [3, 24, 7, 1024]),
            Self::Medium => preset(FlareMode::Blended, [3, 24, 11, 2048]),
            Self::High => preset(FlareMode::Blended, [7, 40, 15, 4096]),
            Self::Ultra => preset(FlareMode::Exact, [15, 64, 31, 4096]),
        }
    }
}
