//! The sky's light on a surface of any direction, as nine numbers a colour: spherical harmonics to the second order (Ramamoorthi &
//! Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps", equations 3 and 13).

use std::f64::consts::PI;

use glam::DVec3;

use super::SkyView;

/// Irradiance from the whole sphere, the ground's below the horizon included, by the sun's above the air. The frame's x axis points to
/// the sun's azimuth, z up.
#[derive(Clone, Copy, Debug)]
pub struct SkyIrradiance {
    /// Coefficients of the products 1, y, z, x, xy, yz, 3z² - 1, xz, x² - y² of a unit normal: E is their sum, 0 at least.
    pub coefficients: [DVec3; 9],
}

/// Bands of altitude and azimuth that are summed.
const BANDS: [usize; 2] = [48, 32];

impl SkyIrradiance {
    /// Of a sky.
    pub fn new(sky: &SkyView) -> Self {
        let mut light = [DVec3::ZERO; 9];
        let [rows, columns] = BANDS;
        for row in 0..rows {
            // Bands of equal solid angle.
            let z = -1.0 + 2.0 * (row as f64 + 0.5) / rows as f64;
            let across = (1.0 - z * z).sqrt();
            for column in 0..columns {
                let azimuth = 2.0 * PI * (column as f64 + 0.5) / columns as f64;
                let normal = DVec3::new(across * azimuth.cos(), across * azimuth.sin(), z);
                let radiance = sky.radiance(azimuth, z.asin());
                for (sum, value) in light.iter_mut().zip(basis(normal)) {
                    *sum += radiance * value;
                }
            }
        }
        let solid_angle = 4.0 * PI / (rows * columns) as f64;
        // Of the basis' normalisation twice, to project and to evaluate, and of the cosine's own harmonics.
        const CONSTANTS: [f64; 9] = [
            0.282_095, 0.488_603, 0.488_603, 0.488_603, 1.092_548, 1.092_548, 0.315_392, 1.092_548, 0.546_274,
        ];
        let cosine = [PI, 2.0 * PI / 3.0, PI / 4.0];
        let order = [0, 1, 1, 1, 2, 2, 2, 2, 2];
        Self {
            coefficients: std::array::from_fn(|k| {
                light[k] * solid_angle * CONSTANTS[k] * CONSTANTS[k] * cosine[order[k]]
            }),
        }
    }

    /// On a surface with a unit normal of the sun's frame.
    pub fn on(&self, normal: DVec3) -> DVec3 {
        let terms = self.coefficients.iter().zip(basis(normal));
        terms
            .map(|(coefficient, value)| *coefficient * value)
            .sum::<DVec3>()
            .max(DVec3::ZERO)
    }
}

fn basis(n: DVec3) -> [f64; 9] {
    [
        1.0,
        n.y,
        n.z,
        n.x,
        n.x * n.y,
        n.y * n.z,
        3.0 * n.z * n.z - 1.0,
        n.x * n.z,
        n.x * n.x - n.y * n.y,
    ]
}

#[cfg(test)]
mod tests {
    use super::super::Atmosphere;
    use super::*;

    /// Against the sum over directions with the cosine itself: the harmonics' own error is a few per cent, and most under a low
    /// sun, whose glow is narrow (section 4 of the paper).
    #[test]
    fn harmonics_give_the_irradiance() {
        for altitude in [5.0_f64, 30.0, 70.0] {
            let sky = Atmosphere::get().sky_view(altitude.to_radians().sin());
            let light = SkyIrradiance::new(&sky);
            for normal in [DVec3::Z, DVec3::X, DVec3::Y, DVec3::new(-0.6, 0.0, 0.8)] {
                let mut sum = DVec3::ZERO;
                for row in 0..200 {
                    let z: f64 = -1.0 + (f64::from(row) + 0.5) / 100.0;
                    for column in 0..100 {
                        let azimuth = 2.0 * PI * (f64::from(column) + 0.5) / 100.0;
                        let across = (1.0 - z * z).sqrt();
                        let direction = DVec3::new(across * azimuth.cos(), across * azimuth.sin(), z);
                        sum += sky.radiance(azimuth, z.asin()) * direction.dot(normal).max(0.0);
                    }
                }
                let exact = sum * 4.0 * PI / 20_000.0;
                let luminance = |light: DVec3| light.dot(DVec3::new(0.2126, 0.7152, 0.0722));
                let error = (luminance(light.on(normal)) / luminance(exact) - 1.0).abs();
                assert!(error < 0.10, "{altitude} {normal}: {} {exact}", light.on(normal));
            }
        }
    }
}
