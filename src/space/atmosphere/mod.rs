//! The clear sky: Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique" (CGF 39(4)), with the
//! coefficients of Bruneton & Neyret 2008 and Bruneton 2017. Spherical air with Rayleigh and Mie scattering and ozone, all orders of
//! scattering. On the CPU only: its tables are small, and made anew when the sun moves.
//!
//! ```text
//! medium ─▶ transmittance ─▶ multiple_scattering ─▶ sky_view (the sky from a place) ─▶ irradiance (its light on a surface)
//! ```
//! Lengths are kilometres, colours linear sRGB by the coefficients at 680, 550 and 440 nm, radiance in units of the irradiance of the
//! sun above the air.

mod irradiance;
mod medium;
mod multiple_scattering;
mod sky_view;
mod transmittance;

use std::sync::LazyLock;

use glam::DVec3;

pub use irradiance::SkyIrradiance;
pub use medium::{
    EYE_KM, GROUND_ALBEDO, GROUND_KM, HAZE_PER_KM, MIE_G, Medium, TOP_KM, mie_phase, rayleigh_phase,
};
pub use sky_view::{SKY_VIEW_SIZE, SkyTexel, SkyView};

use multiple_scattering::MultipleScattering;
use transmittance::Transmittance;

/// What does not depend on the sun.
pub struct Atmosphere {
    transmittance: Transmittance,
    scattering: MultipleScattering,
}

impl Atmosphere {
    /// The one atmosphere, made on first use.
    pub fn get() -> &'static Self {
        static ATMOSPHERE: LazyLock<Atmosphere> = LazyLock::new(|| {
            let transmittance = Transmittance::new();
            let scattering = MultipleScattering::new(&transmittance);
            Atmosphere {
                transmittance,
                scattering,
            }
        });
        &ATMOSPHERE
    }

    /// The fraction of the sun's light that comes through the air to the ground, its disc half set included. `sine`: of the altitude of
    /// the disc's centre.
    pub fn sunlight(&self, sine: f64) -> DVec3 {
        self.transmittance.sun(EYE_KM, sine)
    }

    /// The sky for a sun whose altitude has this sine.
    pub fn sky_view(&self, sine: f64) -> SkyView {
        SkyView::new(&self.transmittance, &self.scattering, sine)
    }
}
