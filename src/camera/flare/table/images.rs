//! The table of whole images by the angle of the light, and by its azimuth where the aperture or the lens has no symmetry: out
//! of photos of a small light (KR 10-1658883), or drawn.
//!
//! Radiance is for a light of irradiance 1; stored as 8-bit square roots over the part of the film that is lit.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::camera::flare::Aperture;

/// Most pixels along an image's edge.
pub const MAX_SIDE: u32 = 1024;

/// An image of the light's flare.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightImage {
    /// Angle of the light from the axis, radians.
    pub angle: f64,
    /// Its direction in the picture, from right towards up, radians.
    pub azimuth: f64,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Least coordinates on the film, millimetres, x right and y up.
    pub min_mm: [f64; 2],
    /// Greatest coordinates.
    pub max_mm: [f64; 2],
    /// Radiance of the brightest value.
    brightest: f32,
    /// RGB, rows from the top: 255 · root of the fraction of the brightest.
    #[serde(with = "serde_bytes")]
    roots: Vec<u8>,
}

/// Images by angle and azimuth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImageTable {
    /// Whether the linear part of the flare is drawn beside the images.
    pub with_linear: bool,
    /// f-number it was drawn for; none for photos.
    pub f_number: Option<f64>,
    /// Iris it was drawn with; none for photos.
    pub aperture: Option<Aperture>,
    images: Vec<LightImage>,
}

/// An image to blend in.
#[derive(Clone, Copy, Debug)]
pub struct EvaluatedImage<'a> {
    /// It.
    pub image: &'a LightImage,
    /// Its index in the table.
    pub index: usize,
    /// Fraction of its light.
    pub fraction: f64,
    /// To be rotated by about the centre of the film, anticlockwise, radians.
    pub rotation: f64,
}

impl LightImage {
    /// Of linear radiance on a film that spans `half_mm` from its centre, RGB, rows from the top; cut to what is lit.
    pub fn new(angle: f64, azimuth: f64, radiance: &[[f32; 3]], size: [u32; 2], half_mm: [f64; 2]) -> Self {
        let brightest = radiance
            .iter()
            .flatten()
            .fold(0.0_f32, |max, &value| max.max(value));
        let root =
            |value: f32| (255.0 * (value.max(0.0) / brightest.max(f32::MIN_POSITIVE)).sqrt()).round() as u8;
        let [columns, rows] = size.map(|side| side as usize);
        let lit = |column: usize, row: usize| {
            radiance[row * columns + column]
                .iter()
                .any(|&value| root(value) > 0)
        };
        let (mut first, mut last) = ([columns, rows], [0, 0]);
        for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
            if lit(column, row) {
                first = [first[0].min(column), first[1].min(row)];
                last = [last[0].max(column + 1), last[1].max(row + 1)];
            }
        }
        if first[0] >= last[0] {
            (first, last) = ([0, 0], [1, 1]);
        }
        let roots = (first[1]..last[1])
            .flat_map(|row| &radiance[row * columns + first[0]..row * columns + last[0]])
            .flatten()
            .map(|&value| root(value))
            .collect();
        let x_mm = |column: usize| (2.0 * column as f64 / columns as f64 - 1.0) * half_mm[0];
        let y_mm = |row: usize| (1.0 - 2.0 * row as f64 / rows as f64) * half_mm[1];
        Self {
            angle,
            azimuth,
            size: [(last[0] - first[0]) as u32, (last[1] - first[1]) as u32],
            min_mm: [x_mm(first[0]), y_mm(last[1])],
            max_mm: [x_mm(last[0]), y_mm(first[1])],
            brightest,
            roots,
        }
    }

    /// Linear radiance, RGB, rows from the top.
    pub fn radiance(&self) -> Vec<[f32; 3]> {
        let (pixels, _) = self.roots.as_chunks::<3>();
        let value = |root: u8| (f32::from(root) / 255.0).powi(2) * self.brightest;
        pixels.iter().map(|rgb| rgb.map(value)).collect()
    }

    fn is_sound(&self) -> bool {
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        let numbers = [self.min_mm, self.max_mm, [self.angle, self.azimuth]];
        pixels > 0
            && 3 * pixels == self.roots.len() as u64
            && self.size.iter().all(|&side| side <= MAX_SIDE)
            && self.brightest.is_finite()
            && self.brightest >= 0.0
            && (0.0..TAU).contains(&self.azimuth)
            && (0..2).all(|axis| self.min_mm[axis] < self.max_mm[axis])
            && numbers.iter().flatten().all(|number| number.is_finite())
    }
}

impl ImageTable {
    /// Of images in any order; `drawn_for`: f-number and iris.
    pub fn new(mut images: Vec<LightImage>, with_linear: bool, drawn_for: Option<(f64, Aperture)>) -> Self {
        for image in &mut images {
            image.azimuth = image.azimuth.rem_euclid(TAU);
        }
        images.sort_by(|a, b| a.azimuth.total_cmp(&b.azimuth).then(a.angle.total_cmp(&b.angle)));
        Self {
            with_linear,
            f_number: drawn_for.map(|(f_number, _)| f_number),
            aperture: drawn_for.map(|(_, aperture)| aperture),
            images,
        }
    }

    /// Number of images.
    pub fn len(&self) -> usize {
        self.images.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.images.is_empty()
    }

    /// Largest angle of an image, radians.
    pub fn max_angle(&self) -> f64 {
        self.images.iter().map(|image| image.angle).fold(0.0, f64::max)
    }

    /// Whether two images are of the same angles.
    pub(super) fn repeats(&self) -> bool {
        let same = |pair: &[LightImage]| (pair[0].azimuth, pair[0].angle) == (pair[1].azimuth, pair[1].angle);
        self.images.windows(2).any(same)
    }

    pub(super) fn is_sound(&self) -> bool {
        let ordered =
            |pair: &[LightImage]| (pair[0].azimuth, pair[0].angle) < (pair[1].azimuth, pair[1].angle);
        !self.is_empty()
            && self.images.iter().all(LightImage::is_sound)
            && self.images.windows(2).all(ordered)
    }

    /// The images that make the flare of a light, at most four: the nearest angles on both sides, at the nearest azimuths on
    /// both sides where there are several, each rotated by what is left. None beyond the largest angle.
    pub fn evaluate(&self, angle: f64, azimuth: f64) -> Vec<EvaluatedImage<'_>> {
        let columns: Vec<&[LightImage]> = self.images.chunk_by(|a, b| a.azimuth == b.azimuth).collect();
        let azimuth = azimuth.rem_euclid(TAU);
        // Azimuths on both sides, round the circle.
        let next = columns
            .iter()
            .position(|column| column[0].azimuth.rem_euclid(TAU) > azimuth)
            .unwrap_or(0);
        let before = (next + columns.len() - 1) % columns.len();
        let from_to = |from: f64, to: f64| (to - from).rem_euclid(TAU);
        let [from, to] = [before, next].map(|k| columns[k][0].azimuth.rem_euclid(TAU));
        let span = from_to(from, to);
        let fraction = if before == next || span <= 0.0 {
            0.0
        } else {
            from_to(from, azimuth) / span
        };
        let mut evaluated = Vec::new();
        for (column, fraction) in [(before, 1.0 - fraction), (next, fraction)] {
            let images = columns[column];
            let first: usize = columns[..column].iter().map(|column| column.len()).sum();
            let Some(above) = images.iter().position(|image| image.angle >= angle) else {
                continue;
            };
            let below = above.saturating_sub(1);
            let span = images[above].angle - images[below].angle;
            let along = if span > 0.0 {
                (angle - images[below].angle) / span
            } else {
                1.0
            };
            for (k, part) in [(below, 1.0 - along), (above, along)] {
                if fraction * part > 0.0 {
                    evaluated.push(EvaluatedImage {
                        image: &images[k],
                        index: first + k,
                        fraction: fraction * part,
                        rotation: azimuth - images[k].azimuth,
                    });
                }
            }
        }
        evaluated
    }
}
