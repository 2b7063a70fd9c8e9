//! The starburst: Fraunhofer diffraction of the aperture, by FFT.
//!
//! Far-field amplitude is the Fourier transform of the opening (Goodman, *Introduction to Fourier Optics*, section 4.3):
//! one bin of the transform of a mask that spans `extent` pupil diameters lies at λ N / extent on the sensor, for f-number N. The
//! pattern is the same for every wavelength but for its size, so one transform serves all. Lee & Eisemann 2013, section 4;
//! Ritschel et al. 2009.

use glam::DVec2;
use num_complex::{Complex, Complex32, Complex64};
use rayon::prelude::*;
use rustfft::{FftDirection, FftNum, FftPlanner};

use crate::camera::flare::{Aperture, Wavelength};

/// The power of the far field of an aperture.
#[derive(Clone, Debug)]
pub struct Diffraction {
    /// Bins along an edge, zero frequency in the centre (`size / 2`).
    pub size: usize,
    /// Fraction of all power per bin, rows from -y.
    pub power: Vec<f64>,
    /// Size of the mask in diameters of the pupil.
    pub extent: f64,
}

/// Distance from the centre within which light hardly spreads, pixels.
const CORE_PIXELS: f64 = 2.0;

/// Part of the pattern that is shown at a distance from its centre, by half its side: none at its border, so that no edge shows.
pub fn shown(distance: f64) -> f64 {
    let rim = ((distance - 0.5) / 0.5).clamp(0.0, 1.0);
    1.0 - rim * rim * (3.0 - 2.0 * rim)
}

/// 2D discrete Fourier transform in place, rows then columns, not scaled.
pub fn fft_2d<T: FftNum>(size: usize, field: &mut Vec<Complex<T>>) {
    let fft = FftPlanner::new().plan_fft(size, FftDirection::Forward);
    let rows_of = |field: &mut Vec<Complex<T>>| {
        field.par_chunks_mut(size).for_each(|row| fft.process(row));
        let transposed: Vec<Complex<T>> = (0..size * size)
            .into_par_iter()
            .map(|k| field[(k % size) * size + k / size])
            .collect();
        *field = transposed;
    };
    rows_of(field);
    rows_of(field);
}

impl Diffraction {
    /// Of an aperture on a mask of `size` x `size` texels that spans `extent` pupil diameters.
    pub fn from_aperture(aperture: &Aperture, size: usize, extent: f64) -> Self {
        let mut mask: Vec<f64> = aperture
            .mask(size as u32, extent)
            .into_iter()
            .map(|texel| f64::from(texel) / 255.0)
            .collect();
        soil(&mut mask, size, extent, aperture.dirt);
        let mut field: Vec<Complex32> = mask.iter().map(|&open| Complex32::from(open as f32)).collect();
        fft_2d(size, &mut field);
        let power_of = |value: &Complex32| f64::from(value.re).powi(2) + f64::from(value.im).powi(2);
        let total: f64 = field.iter().map(power_of).sum();
        let half = size / 2;
        let power = (0..size * size)
            .map(|k| {
                let (column, row) = ((k % size + half) % size, (k / size + half) % size);
                power_of(&field[row * size + column]) / total
            })
            .collect();
        Self { size, power, extent }
    }

    /// Distance of neighbouring bins on the sensor, millimetres.
    pub fn bin_mm(&self, wavelength_um: f64, f_number: f64) -> f64 {
        wavelength_um * 1e-3 * f_number / self.extent
    }

    /// Spread of a distant disc on the sensor: an image of `pixels` x `pixels` over `span_mm` from its centre, linear sRGB, in
    /// fractions of the light per square millimetre. `disc_mm` is the radius of the disc's sharp image. Towards the image's
    /// border it fades to nothing (`shown`). Without `core` the light that hardly spreads is left out; it comes second, as a fraction
    /// of all by channel.
    pub fn spread(
        &self,
        colours: &[Wavelength],
        f_number: f64,
        disc_mm: f64,
        (pixels, span_mm): (usize, f64),
        core: bool,
    ) -> (Vec<[f32; 3]>, [f64; 3]) {
        let pixel_mm = 2.0 * span_mm / pixels as f64;
        let mut points: Vec<Vec<f64>> = colours
            .par_iter()
            .map(|colour| self.splat(self.bin_mm(colour.um, f_number) / pixel_mm, pixels))
            .collect();
        let centre = 0.5 * pixels as f64;
        let mut left_out = [0.0; 3];
        if !core {
            for (colour, points) in colours.iter().zip(&mut points) {
                for (k, point) in points.iter_mut().enumerate() {
                    let at = DVec2::new((k % pixels) as f64 + 0.5, (k / pixels) as f64 + 0.5);
                    if at.distance(DVec2::splat(centre)) < CORE_PIXELS {
                        for (sum, fraction) in left_out.iter_mut().zip(colour.rgb) {
                            *sum += fraction * *point;
                        }
                        *point = 0.0;
                    }
                }
            }
        }
        let channels: Vec<Vec<f64>> = (0..3)
            .into_par_iter()
            .map(|channel| {
                let mut sum = vec![0.0; pixels * pixels];
                for (colour, points) in colours.iter().zip(&points) {
                    let fraction = colour.rgb[channel] / (pixel_mm * pixel_mm);
                    sum.iter_mut()
                        .zip(points)
                        .for_each(|(sum, point)| *sum += fraction * point);
                }
                over_disc(&sum, pixels, disc_mm / pixel_mm)
            })
            .collect();
        let image = (0..pixels * pixels)
            .map(|k| {
                let at =
                    DVec2::new((k % pixels) as f64 + 0.5, (k / pixels) as f64 + 0.5) * pixel_mm - span_mm;
                let shown = shown(at.length() / span_mm);
                [0, 1, 2].map(|channel: usize| (channels[channel][k].max(0.0) * shown) as f32)
            })
            .collect();
        (image, left_out)
    }

    /// All bins put onto an image whose pixels are 1 / `scale` bins wide, its centre in the centre.
    fn splat(&self, scale: f64, pixels: usize) -> Vec<f64> {
        let mut image = vec![0.0; pixels * pixels];
        let half = 0.5 * pixels as f64 - 0.5;
        for (k, &power) in self.power.iter().enumerate() {
            let bin = DVec2::new((k % self.size) as f64, (k / self.size) as f64) - (self.size / 2) as f64;
            let at = bin * scale + half;
            let floor = at.floor();
            if floor.min_element() < 0.0 || floor.max_element() + 1.0 >= pixels as f64 {
                continue;
            }
            let f = at - floor;
            let index = floor.y as usize * pixels + floor.x as usize;
            image[index] += power * (1.0 - f.x) * (1.0 - f.y);
            image[index + 1] += power * f.x * (1.0 - f.y);
            image[index + pixels] += power * (1.0 - f.x) * f.y;
            image[index + pixels + 1] += power * f.x * f.y;
        }
        image
    }
}

/// An image of a point made that of a disc of `radius` pixels: convolution, by FFT.
fn over_disc(image: &[f64], size: usize, radius: f64) -> Vec<f64> {
    let wrapped = |index: usize| index.min(size - index) as f64;
    let mut disc: Vec<Complex64> = (0..size * size)
        .map(|k| {
            let distance = wrapped(k % size).hypot(wrapped(k / size));
            Complex64::from((radius - distance + 0.5).clamp(0.0, 1.0))
        })
        .collect();
    // A disc of less than a pixel is a point.
    disc[0] = Complex64::from(1.0);
    let total: f64 = disc.iter().map(|value| value.re).sum();
    let mut field: Vec<Complex64> = image.iter().map(|&value| Complex64::from(value)).collect();
    fft_2d(size, &mut disc);
    fft_2d(size, &mut field);
    // Back by the transform of the conjugate.
    let mut product: Vec<Complex64> = field.iter().zip(&disc).map(|(a, b)| (a * b).conj()).collect();
    fft_2d(size, &mut product);
    let scale = 1.0 / (total * (size * size) as f64);
    product.iter().map(|value| value.re * scale).collect()
}

/// Specks and scratches that hold light back, the same ones every time.
fn soil(mask: &mut [f64], size: usize, extent: f64, dirt: u32) {
    let mut state = 0x9e37_79b9_u32;
    let mut random = || {
        // xorshift32 (Marsaglia 2003).
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        f64::from(state) / f64::from(u32::MAX)
    };
    let texel = 2.0 * extent / size as f64;
    for index in 0..dirt {
        let from = DVec2::new(random(), random()) * 2.0 - 1.0;
        let is_scratch = index % 3 == 0;
        let along = if is_scratch {
            DVec2::from_angle(random() * std::f64::consts::PI) * (0.2 + 0.6 * random())
        } else {
            DVec2::ZERO
        };
        let radius = if is_scratch {
            0.004
        } else {
            0.004 + 0.012 * random()
        };
        let (min, max) = (from.min(from + along) - radius, from.max(from + along) + radius);
        let index_of = |position: f64| (((position + extent) / texel).max(0.0) as usize).min(size);
        for row in index_of(min.y)..index_of(max.y + texel) {
            for column in index_of(min.x)..index_of(max.x + texel) {
                let at = DVec2::new(column as f64 + 0.5, row as f64 + 0.5) * texel - extent;
                let fraction = if is_scratch {
                    ((at - from).dot(along) / along.length_squared()).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                if at.distance(from + fraction * along) < radius {
                    mask[row * size + column] *= 0.25;
                }
            }
        }
    }
}
