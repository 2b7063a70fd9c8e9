//! How lenses' flags are written: surface numbers from 1, millimetres, f-numbers; and what follows from them.

use glam::DVec2;

use super::CommandError;
use crate::camera::flare::Aperture;
use crate::camera::lens::{D_LINE_UM, Lens};
use crate::camera::{Ghost, Paraxial};

/// An f-number.
pub fn f_number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (0.5..=256.0).contains(&number) => Ok(number),
        _ => Err("give an f-number between 0.5 and 256".to_owned()),
    }
}

/// Two surface numbers `I,J`.
pub fn pair(text: &str) -> Result<[usize; 2], String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[first, second]) if first > second && second > 0 => Ok([first, second]),
        _ => Err("give two surface numbers I,J with I > J, such as 9,7".to_owned()),
    }
}

/// `X,Y`.
pub fn millimetres(text: &str) -> Result<DVec2, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y]) if x.is_finite() && y.is_finite() => Ok(DVec2::new(x, y)),
        _ => Err("give two numbers X,Y".to_owned()),
    }
}

/// A ghost from surface numbers counted from 1.
pub fn ghost_of(lens: &Lens, [first, second]: [usize; 2]) -> Result<Ghost, CommandError> {
    if first > lens.surfaces.len() {
        return Err(CommandError::Argument(format!(
            "{}: there is no surface {first}; it has {}, the stop counted",
            lens.name,
            lens.surfaces.len()
        )));
    }
    Ok(Ghost {
        first: first - 1,
        second: second - 1,
    })
}

/// An iris with blades.
pub fn aperture(blades: u32) -> Aperture {
    Aperture {
        blades,
        ..Aperture::default()
    }
}

/// Angle of the film's corner and a third more, radians.
pub fn max_angle(lens: &Lens) -> f64 {
    let half_diagonal = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
    let corner = half_diagonal.atan2(Paraxial::new(lens, D_LINE_UM, None).efl_mm.abs());
    (1.35 * corner).clamp(0.37, 1.2)
}
