//! Reads the lens table of pbrt's realistic camera (Pharr, Jakob & Humphreys, *Physically Based Rendering*, 3rd ed.,
//! section 6.4.1): per line radius, thickness, index behind it, diameter of the clear aperture, all in millimetres from the
//! front; the first line with radius 0 and air behind it is the stop. Lines that begin with # are comments.

use std::path::Path;

use super::csv::stem;
use super::prescription::{full_frame, plane_or};
use super::{Glass, Lens, LensError, Surface};

/// Reads the text of such a file; `path` is named in errors.
pub fn read(path: &Path, text: &str) -> Result<Lens, LensError> {
    let (mut surfaces, mut stop) = (Vec::new(), None);
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default();
        if line.trim().is_empty() {
            continue;
        }
        let numbers: Option<Vec<f64>> = line.split_whitespace().map(|word| word.parse().ok()).collect();
        let Some(&[radius, thickness, index, diameter]) = numbers.as_deref() else {
            return Err(LensError::Syntax {
                path: path.to_owned(),
                what: format!("line {number} is not four numbers: radius, thickness, index, diameter"),
            });
        };
        let radius = plane_or(radius);
        if radius == 0.0 && stop.is_none() && (index == 0.0 || index == 1.0) {
            stop = Some(surfaces.len());
        }
        // The table writes both 0 and 1 for air; it has no dispersion.
        let index = if index == 0.0 { 1.0 } else { index };
        surfaces.push(Surface {
            radius_mm: radius,
            glass: Glass::model(index, 0.0),
            semi_diameter_mm: Some(0.5 * diameter),
            ..Surface::plane(thickness)
        });
    }
    let source = text
        .lines()
        .find_map(|line| line.strip_prefix('#'))
        .map(|line| line.trim().to_owned())
        .unwrap_or_default();
    Lens::new(stem(path), source, surfaces, stop, full_frame())
}
