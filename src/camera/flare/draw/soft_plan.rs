//! Which ghosts are drawn on texels of which size, and how they are softened: in the iris as they are drawn, or on the sensor after.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec2;

use super::touched_blocks::TouchedBlocks;
use crate::camera::flare::ghost::{Coverage, GhostTriangles};

/// Least texels in the radius of a ghost that is softened in the iris: what its edge needs to be drawn on them.
const IRIS_TEXELS: f64 = 1.5;
/// The same of one that is softened on the sensor: what a disc needs to be round.
const SENSOR_TEXELS: f64 = 2.5;
/// Radius in pixels up to which nothing is softened on the sensor.
const SHARP_TO: f64 = 0.5;
/// Radii told apart there, per doubling.
const STEPS: f64 = 6.0;
/// Step at a ghost's edge, by the image's white, up to which its texels may double: no eye sees on which texels it is drawn.
const FAINT_STEP: f64 = 0.04;
/// Most doublings of that.
const MAX_FAINT: u32 = 3;
/// The same on the sensor, where a disc needs more than a texel.
const MAX_FAINT_DISC: u32 = 1;
/// What all ghosts that are left out are together, by the image's white: a quarter of a step of 8 bits.
const LEFT_OUT: f64 = 0.001;
/// Fraction of the image that is brighter than white: more than `auto_exposure` takes, to be on the safe side.
const BRIGHTER_FRACTION: f64 = 0.02;
/// Texels that a ghost covers at least: what is smaller is enlarged, so that none falls between texels.
const MIN_TEXELS: f64 = 4.0;

/// Ghosts of nearly the same radius that are softened together on the sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct SoftClass {
    /// Doublings of the texels that they are softened on.
    pub level: u32,
    /// Radius, texels.
    pub radius: f64,
    /// Indices of the ghosts.
    pub ghosts: Vec<usize>,
    /// Least and greatest pixels of the parts of the image that they touch, radius and all; no two overlap.
    pub parts: Vec<[DVec2; 2]>,
}

/// By how much a ghost is enlarged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enlarged {
    /// Centre of the ghost on the sensor, millimetres.
    pub centre_mm: DVec2,
    /// Factors about it.
    pub by: DVec2,
}

/// How the ghosts of a mesh are drawn on an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SoftPlan {
    /// Ghosts softened in the iris, by doublings of the texels that they are drawn on.
    pub in_iris: Vec<Vec<usize>>,
    /// Those softened on the sensor, the coarsest first.
    pub on_sensor: Vec<SoftClass>,
    /// How much each is enlarged.
    pub enlarged: Vec<Enlarged>,
    /// Of those on the image, the ones too faint to be seen even together.
    pub left_out: usize,
}

/// What an image shows of the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageScale {
    /// Half its size, millimetres.
    pub half_mm: DVec2,
    /// Its size, pixels.
    pub size: DVec2,
    /// Radiance for a light of irradiance 1 that is white at the brightest: of ghosts brighter than that, fainter ones are seen.
    pub max_white: f64,
}

impl ImageScale {
    /// Pixels of a millimetre.
    fn pixels_per_mm(&self) -> f64 {
        0.5 * self.size.y / self.half_mm.y
    }

    /// Least and greatest pixel, from the top left, of what lies between least and greatest coordinates on the sensor or so many
    /// pixels beside it.
    fn pixels(&self, corners_mm: [DVec2; 2], pad_px: f64) -> [DVec2; 2] {
        let [a, b] = corners_mm.map(|mm| {
            let unit = DVec2::new(mm.x, -mm.y) / self.half_mm;
            (0.5 + 0.5 * unit) * self.size
        });
        [a.min(b) - pad_px, a.max(b) + pad_px]
    }
}

impl SoftPlan {
    /// For a mesh's ghosts; texels double `max_level` times at most. Ghosts beside the image are left out.
    pub fn new(ghosts: &[GhostTriangles], scale: &ImageScale, max_level: u32) -> Self {
        let mut plan = Self {
            in_iris: vec![Vec::new(); max_level as usize + 1],
            ..Self::default()
        };
        let mut bins: BTreeMap<(u32, i32), Bin> = BTreeMap::new();
        let steps = steps(ghosts, scale);
        let too_faint = too_faint(&steps);
        for (index, ghost) in ghosts.iter().enumerate() {
            let radius_px = ghost.radius_mm * scale.pixels_per_mm();
            let is_in_iris = ghost.in_iris.is_some() || radius_px < SHARP_TO;
            let min_texels = if is_in_iris { IRIS_TEXELS } else { SENSOR_TEXELS };
            let mut level = doublings(radius_px / min_texels, max_level);
            if radius_px > SHARP_TO {
                let max_faint = if is_in_iris { MAX_FAINT } else { MAX_FAINT_DISC };
                level = (level + doublings(FAINT_STEP / steps[index], max_faint)).min(max_level);
            }
            // Texels of what is softened on the sensor are half as large when it is drawn.
            let drawn_level = if is_in_iris {
                level
            } else {
                level.saturating_sub(1)
            };
            let [min, max] = ghost.bounds_mm;
            let size_px = ((max - min) * scale.pixels_per_mm()).max(DVec2::splat(1e-6));
            // A sharp ghost is drawn as it is.
            let drawn_texels = if radius_px > SHARP_TO { MIN_TEXELS } else { 0.0 };
            let min_px = drawn_texels * f64::from(1_u32 << drawn_level);
            plan.enlarged.push(Enlarged {
                centre_mm: 0.5 * (min + max),
                by: (min_px / size_px).max(DVec2::ONE),
            });
            let pad_px = radius_px + 2.0 * min_px + 1.0;
            let bounds = scale.pixels([min, max], pad_px);
            if bounds[1].min_element() < 0.0 || (bounds[0] - scale.size).max_element() > 0.0 {
                continue;
            }
            if steps[index] <= too_faint {
                plan.left_out += 1;
                continue;
            }
            if is_in_iris {
                plan.in_iris[level as usize].push(index);
                continue;
            }
            let bin = bins.entry((level, (STEPS * radius_px.log2()).round() as i32));
            let bin = bin.or_insert_with(|| Bin::new(scale.size, level));
            bin.add(index, ghost, radius_px);
            let Enlarged { centre_mm, by } = plan.enlarged[index];
            for touched in ghost.coverage.iter().flat_map(Coverage::rectangles) {
                let enlarged = touched.map(|mm| centre_mm + (mm - centre_mm) * by);
                bin.touched.touch(scale.pixels(enlarged, pad_px));
            }
        }
        let classes = bins.into_iter().rev();
        plan.on_sensor = classes.map(|((level, _), bin)| bin.class(level)).collect();
        plan
    }
}

/// Mean radiance of each ghost, by the image's white: that which the brightest ghosts on the smallest part of the image reach.
fn steps(ghosts: &[GhostTriangles], scale: &ImageScale) -> Vec<f64> {
    let radiance: Vec<f64> = ghosts
        .iter()
        .map(|ghost| ghost.light / ghost.area_mm2.max(1e-12))
        .collect();
    let mut brightest: Vec<usize> = (0..ghosts.len()).collect();
    brightest.sort_by(|&a, &b| radiance[b].total_cmp(&radiance[a]));
    let mut rest_mm2 = BRIGHTER_FRACTION * 4.0 * scale.half_mm.element_product();
    let mut white = f64::MIN_POSITIVE;
    for index in brightest {
        let [min, max] = ghosts[index].bounds_mm;
        let (whole, on_image) = (max - min, max.min(scale.half_mm) - min.max(-scale.half_mm));
        if on_image.min_element() <= 0.0 {
            continue;
        }
        // Spread over the light's disc, and as much of it as is on the image.
        let part = on_image.element_product() / whole.element_product();
        let soft_mm2 = std::f64::consts::PI * ghosts[index].radius_mm.powi(2);
        let area_mm2 = ghosts[index].area_mm2.max(soft_mm2);
        white = f64::max(white, ghosts[index].light / area_mm2);
        rest_mm2 -= area_mm2 * part;
        if rest_mm2 <= 0.0 {
            white = ghosts[index].light / area_mm2;
            break;
        }
    }
    let white = white.min(3.0 * scale.max_white).max(f64::MIN_POSITIVE);
    radiance.iter().map(|radiance| radiance / white).collect()
}

/// Radiance by the image's white up to which ghosts are too faint to be seen, all together.
fn too_faint(steps: &[f64]) -> f64 {
    let mut faintest = steps.to_vec();
    faintest.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    let seen = faintest.iter().position(|step| {
        sum += step;
        sum > LEFT_OUT
    });
    match seen {
        Some(0) | None => 0.0,
        Some(first) => faintest[first - 1],
    }
}

/// How often a texel of one pixel can double.
fn doublings(texel_px: f64, max_level: u32) -> u32 {
    (texel_px.max(1.0).log2().floor() as u32).min(max_level)
}

/// A class that is being filled.
struct Bin {
    ghosts: Vec<usize>,
    touched: TouchedBlocks,
    radius_by_light: f64,
    light: f64,
}

impl Bin {
    fn new(size: DVec2, level: u32) -> Self {
        Self {
            ghosts: Vec::new(),
            touched: TouchedBlocks::new(size, 1 << level),
            radius_by_light: 0.0,
            light: 0.0,
        }
    }

    fn add(&mut self, index: usize, ghost: &GhostTriangles, radius_px: f64) {
        self.ghosts.push(index);
        let light = ghost.light.max(f64::MIN_POSITIVE);
        self.radius_by_light += radius_px * light;
        self.light += light;
    }

    /// With the mean radius of its light.
    fn class(self, level: u32) -> SoftClass {
        SoftClass {
            level,
            radius: self.radius_by_light / self.light / f64::from(1_u32 << level),
            ghosts: self.ghosts,
            parts: self.touched.parts(),
        }
    }
}

/// Vertices of each ghost of a mesh.
pub fn vertex_ranges(ghosts: &[GhostTriangles]) -> Vec<Range<usize>> {
    let mut end = 0;
    ghosts
        .iter()
        .map(|ghost| {
            let start = end;
            end += ghost.vertices;
            start..end
        })
        .collect()
}
