//! The iris' mask, and the same softened by discs of many radii: what a point of the sensor sees of a disc of light through the iris.

use rayon::prelude::*;

use crate::camera::flare::{Aperture, MAX_SOFTNESS};
use crate::gpu::{Gpu, filled_texture, filled_volume};

/// Size of the sharp mask, texels.
const MASK_SIZE: u32 = 512;
/// Half its side in radii of the stop: beyond it no light passes.
pub const MASK_EXTENT: f64 = 1.1;
/// Size of a softened mask, texels.
const SOFT_SIZE: u32 = 320;
/// Half its side.
pub const SOFT_EXTENT: f64 = 1.0 + MAX_SOFTNESS + 0.05;
/// Number of softened masks; their radii are a geometric series to the largest.
pub const SOFT_MASKS: u32 = 14;
/// Radius of the first, in radii of the stop: what is softened less is sharp.
pub const MIN_SOFTNESS: f64 = 0.012;

/// The masks on the device.
pub struct IrisMasks {
    /// As it is.
    pub sharp: wgpu::TextureView,
    /// By radius.
    pub soft: wgpu::TextureView,
}

impl IrisMasks {
    /// Uploads those of an iris.
    pub fn new(gpu: &Gpu, aperture: &Aperture) -> Self {
        let format = wgpu::TextureFormat::R8Unorm;
        let sharp = aperture.mask(MASK_SIZE, MASK_EXTENT);
        let mask = aperture.mask(SOFT_SIZE, SOFT_EXTENT);
        let texel = 2.0 * SOFT_EXTENT / f64::from(SOFT_SIZE);
        let soft: Vec<u8> = (0..SOFT_MASKS)
            .into_par_iter()
            .flat_map_iter(|index| over_disc(&mask, SOFT_SIZE as usize, softness(index) / texel))
            .collect();
        let size = [SOFT_SIZE, SOFT_SIZE, SOFT_MASKS];
        Self {
            sharp: filled_texture(gpu, "aperture", [MASK_SIZE; 2], format, &sharp),
            soft: filled_volume(gpu, "soft apertures", size, format, &soft),
        }
    }
}

/// Radius of a softened mask, in radii of the stop.
fn softness(index: u32) -> f64 {
    let along = f64::from(index) / f64::from(SOFT_MASKS - 1);
    MIN_SOFTNESS * (MAX_SOFTNESS / MIN_SOFTNESS).powf(along)
}

/// Means over discs of `radius` texels, by sums along rows.
fn over_disc(mask: &[u8], size: usize, radius: f64) -> Vec<u8> {
    let mut sums = Vec::with_capacity(size * (size + 1));
    for row in mask.chunks_exact(size) {
        sums.push(0_u32);
        let mut sum = 0;
        sums.extend(row.iter().map(|&texel| {
            sum += u32::from(texel);
            sum
        }));
    }
    // Half the length of the disc's rows; their ends lie between texels.
    let extent = radius.floor() as isize;
    let halves: Vec<f64> = (-extent..=extent)
        .map(|row| (radius * radius - (row * row) as f64).max(0.0).sqrt() + 0.25)
        .collect();
    let area: f64 = halves.iter().map(|half| 2.0 * half).sum();
    let up_to = |row: usize, x: f64| {
        let x = x.clamp(0.0, size as f64);
        let whole = (x as usize).min(size - 1);
        let at = |k: usize| f64::from(sums[row * (size + 1) + k]);
        at(whole) + (x - whole as f64) * (at(whole + 1) - at(whole))
    };
    (0..size * size)
        .map(|k| {
            let (column, row) = (k % size, k / size);
            let mut sum = 0.0;
            for (offset, half) in (-extent..=extent).zip(&halves) {
                let Some(row) = row.checked_add_signed(offset).filter(|row| *row < size) else {
                    continue;
                };
                let centre = column as f64 + 0.5;
                sum += up_to(row, centre + half) - up_to(row, centre - half);
            }
            (sum / area).round().clamp(0.0, 255.0) as u8
        })
        .collect()
}
