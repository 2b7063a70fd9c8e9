//! One ghost at one angle, a knot of the table: a coarse grid of rays in two colours, small.

use glam::DVec2;
use half::f16;
use serde::{Deserialize, Serialize};

use crate::camera::flare::ghost::grid::RayGrid;
use crate::camera::trace::TracedRay;

/// Rays along an edge of a stored grid, even: the least that tells a ghost well enough.
pub const SIZES: [usize; 4] = [10, 14, 20, 28];

/// Rays stored of a grid: the half below the beam's plane, as the other half is its mirror image.
pub const fn stored(size: usize) -> usize {
    size * size / 2
}
/// Wavelengths that are stored, micrometres; others follow by 1 / wavelength², in which glass is nearly linear (Cauchy).
pub const COLOURS_UM: [f64; 2] = [0.475, 0.650];
/// Values of a ray: sensor position x, y (mm), position in the stop x, y (mm), relative height, root of the power.
pub const VALUES: usize = 6;

/// Of those, the ones that the second colour stores too: its power follows by the curve of colours.
const SHIFTED: usize = VALUES - 1;
/// Wavelengths of the curve of colours, micrometres: coatings are far from linear in any power of the wavelength.
pub const CURVE_UM: [f64; 8] = [0.40, 0.44, 0.48, 0.52, 0.56, 0.60, 0.65, 0.70];

/// Height by the barrel up to which rays count for how finely the others are stored.
const PASSING_HEIGHT: f64 = 1.1;
/// What is stored is less: half floats end at 65504.
const MAX_VALUE: f64 = 6e4;

/// Values of one ray.
pub type Values = [f64; VALUES];

/// What is stored of a ray.
pub fn values_of(ray: &TracedRay) -> Values {
    let (at, stop) = (ray.sensor_mm, ray.stop_mm);
    [
        at.x,
        at.y,
        stop.x,
        stop.y,
        ray.relative_height,
        ray.power.max(0.0).sqrt(),
    ]
}

/// Grids at one angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Knot {
    /// Radians.
    pub angle: f64,
    /// Nonlinearity error there (see `nonlinearity`); large where no light gets through.
    pub nonlinearity_error: f32,
    /// The light; none where none gets through.
    pub light: Option<Light>,
}

/// What gets through.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// Least and greatest coordinates of the entrance window, millimetres.
    pub window: [DVec2; 2],
    /// Rays along an edge.
    size: u8,
    /// Centre of the sensor positions, along the beam's plane, millimetres.
    centre_mm: f64,
    /// Value after value, all rays' f16 as `planes`; a lost ray is infinitely high. Sensor positions count from the centre.
    #[serde(with = "serde_bytes")]
    blue: Vec<u8>,
    /// How far the second colour differs, in steps of `red_step`, value after value.
    #[serde(with = "serde_bytes")]
    red: Vec<u8>,
    red_step: [f32; SHIFTED],
    /// Power of a ray in the ghost's centre at `CURVE_UM`, as fractions of its power in the first colour.
    curve: [f32; CURVE_UM.len()],
}

/// A knot as numbers.
#[derive(Clone, Debug)]
pub struct Unpacked {
    /// Rays along an edge.
    pub size: usize,
    /// Least and greatest coordinates of the entrance window, millimetres.
    pub window: [DVec2; 2],
    /// Rays per colour; none where lost.
    pub colours: [Vec<Option<Values>>; 2],
    /// See `Light::curve`.
    pub curve: [f64; CURVE_UM.len()],
}

/// Number of the ray that another's bits are told from: the one before it in its row, or the one in the row before.
fn neighbour(ray: usize, size: usize) -> Option<usize> {
    if !ray.is_multiple_of(size) {
        Some(ray - 1)
    } else {
        ray.checked_sub(size)
    }
}

/// To 7 binary digits, 0.4 %: enough for all but positions on the sensor.
fn rounded(value: f64) -> f16 {
    f16::from_bits(f16::from_f64(value).to_bits().saturating_add(4) & !7)
}

/// Differences from the neighbours, first all low and then all high bytes: what is smooth packs well so.
fn planes(bits: &[u16], size: usize) -> Vec<u8> {
    let differences = bits.iter().enumerate().map(|(ray, bits_here)| {
        bits_here
            .wrapping_sub(neighbour(ray, size).map_or(0, |other| bits[other]))
            .to_le_bytes()
    });
    let (low_bytes, high_bytes): (Vec<u8>, Vec<u8>) = differences.map(|[low, high]| (low, high)).unzip();
    [low_bytes, high_bytes].concat()
}

/// The bits of a grid's rays out of `planes`.
fn from_planes(planes: &[u8], size: usize) -> Vec<u16> {
    let count = stored(size);
    let mut bits = vec![0_u16; count];
    for ray in 0..count {
        let difference = u16::from_le_bytes([planes[ray], planes[ray + count]]);
        bits[ray] = difference.wrapping_add(neighbour(ray, size).map_or(0, |other| bits[other]));
    }
    bits
}

impl Light {
    /// From the traced grids of both colours and the curve of colours. Rays farther than half floats tell are lost.
    pub fn packed(grids: [&RayGrid; 2], curve: [f64; CURVE_UM.len()]) -> Self {
        let size = grids[0].size;
        let values = |grid: &RayGrid| -> Vec<Option<Values>> {
            let stored = grid.rays.iter().take(stored(size));
            stored.map(|ray| ray.as_ref().map(values_of)).collect()
        };
        let [blue, red] = grids.map(values);
        // By the rays that pass: others may lie anywhere.
        let passes = |values: &&Values| values[4] <= PASSING_HEIGHT;
        let alive = || blue.iter().flatten().filter(passes).map(|values| values[0]);
        let centre_mm = alive().sum::<f64>() / alive().count().max(1) as f64;
        let fits = |values: &Values| {
            let [x, y, stop_x, stop_y, height, root] = *values;
            let all = [x - centre_mm, y, stop_x, stop_y, height, root];
            all.iter().all(|value| value.abs() < MAX_VALUE)
        };
        let stored: Vec<[f16; VALUES]> = blue
            .iter()
            .zip(&red)
            .map(|(blue, red)| match (blue, red) {
                (Some(blue), Some(red)) if fits(blue) && fits(red) => {
                    let [x, y, stop_x, stop_y, height, root] = *blue;
                    let positions = [x - centre_mm, y].map(f16::from_f64);
                    let [stop_x, stop_y, height, root] = [stop_x, stop_y, height, root].map(rounded);
                    [positions[0], positions[1], stop_x, stop_y, height, root]
                }
                _ => [f16::INFINITY; VALUES],
            })
            .collect();
        // The second colour against the first as stored, so that roundings do not add up.
        let differences: Vec<Values> = stored
            .iter()
            .zip(&red)
            .map(|(blue, red)| match red {
                Some(red) if blue.iter().all(|value| value.is_finite()) => std::array::from_fn(|k| {
                    let stored = blue[k].to_f64() + if k == 0 { centre_mm } else { 0.0 };
                    red[k] - stored
                }),
                _ => [0.0; VALUES],
            })
            .collect();
        let red_step: [f32; SHIFTED] = std::array::from_fn(|k| {
            let of_passing = differences
                .iter()
                .zip(&stored)
                .filter(|(_, blue)| blue[4].to_f64() <= PASSING_HEIGHT);
            let max = of_passing.map(|(ray, _)| ray[k].abs()).fold(0.0, f64::max);
            (max / 127.0).max(1e-30) as f32
        });
        Self {
            window: [grids[0].min, grids[0].max],
            size: size as u8,
            centre_mm,
            blue: (0..VALUES)
                .flat_map(|k| {
                    planes(
                        &stored.iter().map(|ray| ray[k].to_bits()).collect::<Vec<_>>(),
                        size,
                    )
                })
                .collect(),
            red: (0..SHIFTED)
                .flat_map(|k| differences.iter().map(move |ray| (ray[k], k)))
                .map(|(value, k)| (value / f64::from(red_step[k])).round().clamp(-127.0, 127.0) as i8 as u8)
                .collect(),
            red_step,
            curve: curve.map(|fraction| fraction as f32),
        }
    }

    /// Whether the sizes are those of a table this program writes.
    pub fn is_sound(&self) -> bool {
        let numbers = [
            self.window[0].x,
            self.window[0].y,
            self.window[1].x,
            self.window[1].y,
        ];
        let count = stored(usize::from(self.size));
        SIZES.contains(&usize::from(self.size))
            && self.blue.len() == 2 * VALUES * count
            && self.red.len() == SHIFTED * count
            && self.curve.iter().all(|fraction| fraction.is_finite())
            && numbers.iter().all(|number| number.is_finite())
            && self.centre_mm.is_finite()
            && self.red_step.iter().all(|step| step.is_finite())
    }

    /// Rays along an edge.
    pub fn size(&self) -> usize {
        usize::from(self.size)
    }

    /// Bytes of its numbers.
    pub fn bytes(&self) -> usize {
        self.blue.len() + self.red.len() + 4 * (SHIFTED + CURVE_UM.len()) + 40
    }

    /// The numbers.
    pub fn unpack(&self) -> Unpacked {
        let size = usize::from(self.size);
        let count = stored(size);
        let planes = self.blue.chunks_exact(2 * count);
        let bits: Vec<Vec<u16>> = planes.map(|planes| from_planes(planes, size)).collect();
        let blue = |ray: usize, k: usize| {
            let value = f16::from_bits(bits[k][ray]).to_f64();
            if k == 0 { value + self.centre_mm } else { value }
        };
        let red = |ray: usize, k: usize| {
            if k >= SHIFTED {
                return blue(ray, k);
            }
            let steps = self.red[k * count + ray] as i8;
            blue(ray, k) + f64::from(steps) * f64::from(self.red_step[k])
        };
        let rays = |value: &dyn Fn(usize, usize) -> f64| -> Vec<Option<Values>> {
            (0..count)
                .map(|ray| {
                    let values: Values = std::array::from_fn(|k| value(ray, k));
                    values.iter().all(|value| value.is_finite()).then_some(values)
                })
                .collect()
        };
        Unpacked {
            size,
            window: self.window,
            colours: [rays(&blue), rays(&red)],
            curve: self.curve.map(f64::from),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_give_their_bits_back() {
        for size in SIZES {
            let bits: Vec<u16> = (0..stored(size) as u32)
                .map(|k| (k * k * 977 % 65_536) as u16)
                .collect();
            assert_eq!(from_planes(&planes(&bits, size), size), bits);
        }
    }
}
