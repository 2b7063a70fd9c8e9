//! Notices heights stored in whole steps (whole metres, decimetres, feet) on pixels so fine that the steps show as terraces.
//!
//! Three things together: the heights are multiples of the step; across one pixel a step is a slope that the light shows;
//! and sloping ground has plateaus, most neighbouring pixels being equal. Whole metres on 30 m (SRTM) fail the second: a
//! step there is a slope of 3 %, no terrace, and its surface stays as it was surveyed.

use super::mosaic_source::MosaicSource;
use super::sampler::MosaicSampler;
use super::window::Window;
use crate::source::SourceError;

/// Steps that surveys use, the largest first: metres, and feet.
const STEPS_M: [f64; 6] = [1.0, 0.5, 0.3048, 0.25, 0.2, 0.1];

/// Fraction of the heights that must be multiples: a mosaic may hold some finer ones.
const MULTIPLES: f64 = 0.99;

/// Slope of one step across one pixel from which terraces show.
const TERRACE_SLOPE: f64 = 0.1;

/// Fraction of neighbouring pixels that differ, on sloping ground, up to which it is plateaus.
const PLATEAUS: f64 = 0.5;

/// Blocks read along a side of the mosaic source, and pixels along a side of a block.
const BLOCKS: usize = 5;
const BLOCK: usize = 128;

/// Pixels along a side of the squares in which sloping ground is told from flat.
const SQUARE: usize = 16;

/// True when a height is a multiple of the step, to the rounding of f32.
pub fn is_multiple(height: f32, step_m: f64) -> bool {
    let steps = f64::from(height) / step_m;
    (steps - steps.round()).abs() < 2e-3
}

/// The step in which a mosaic source's heights are stored, metres, where it shows as terraces.
pub fn find_step(mosaic: &MosaicSource) -> Result<Option<f64>, SourceError> {
    if STEPS_M[0] / mosaic.pixel_m < TERRACE_SLOPE {
        return Ok(None);
    }
    let sampler = MosaicSampler::open(mosaic, &mosaic.crs)?;
    let mut windows = Vec::new();
    for k in 0..BLOCKS * BLOCKS {
        let along = [k % BLOCKS, k / BLOCKS];
        let low = [0, 1].map(|axis| {
            let spare = mosaic.size[axis].saturating_sub(BLOCK);
            spare * along[axis] / (BLOCKS - 1)
        });
        let high = [0, 1].map(|axis| (low[axis] + BLOCK).min(mosaic.size[axis]));
        windows.push(sampler.read(low, high)?);
    }
    let heights = || {
        windows
            .iter()
            .flat_map(|window| &window.heights)
            .filter(|h| h.is_finite())
    };
    let count = heights().count() as f64;
    let step = STEPS_M.into_iter().find(|&step| {
        let multiples = heights().filter(|&&height| is_multiple(height, step)).count();
        multiples as f64 > MULTIPLES * count
    });
    Ok(step.filter(|&step| step / mosaic.pixel_m >= TERRACE_SLOPE && are_plateaus(&windows, step)))
}

/// True when most neighbours on sloping ground are equal.
fn are_plateaus(windows: &[Window], step_m: f64) -> bool {
    let (mut pairs, mut differing) = (0_usize, 0_usize);
    for window in windows {
        let [width, height] = window.size;
        for top in (0..height).step_by(SQUARE) {
            for left in (0..width).step_by(SQUARE) {
                let (right, bottom) = ((left + SQUARE).min(width), (top + SQUARE).min(height));
                let at = |column: usize, row: usize| window.heights[row * width + column];
                let known = (top..bottom)
                    .flat_map(|row| (left..right).map(move |column| at(column, row)))
                    .filter(|height| height.is_finite());
                let (min, max) = known.fold((f32::INFINITY, f32::NEG_INFINITY), |(min, max), height| {
                    (min.min(height), max.max(height))
                });
                if f64::from(max - min) < 0.5 * step_m {
                    continue;
                }
                for row in top..bottom {
                    for column in left + 1..right {
                        let (a, b) = (at(column - 1, row), at(column, row));
                        if a.is_finite() && b.is_finite() {
                            pairs += 1;
                            differing += usize::from(a != b);
                        }
                    }
                }
            }
        }
    }
    (differing as f64) < PLATEAUS * pairs as f64
}
