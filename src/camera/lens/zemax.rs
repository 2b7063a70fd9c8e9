//! Reads a Zemax sequential lens file (.zmx): blocks of `SURF n` with TYPE, CURV, DISZ, GLAS, DIAM, CONI, PARM and STOP.
//! Surface 0 is the object and the last one the image; both are left out.

use std::path::Path;

use super::csv::stem;
use super::table::full_frame;
use super::{Glass, Lens, LensError, Surface};

/// Reads the text of such a file; `path` is named in errors.
pub fn read(path: &Path, text: &str) -> Result<Lens, LensError> {
    let syntax = |what: String| LensError::Syntax {
        path: path.to_owned(),
        what,
    };
    let mut to_mm = 1.0;
    let mut name = stem(path);
    let mut rows: Vec<Surface> = Vec::new();
    let mut stop = None;
    for (number, line) in (1..).zip(text.lines()) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let value = |at: usize| -> Result<f64, LensError> {
            let word = words.get(at).copied().unwrap_or_default();
            if word == "INFINITY" {
                return Ok(0.0);
            }
            word.parse()
                .map_err(|_| syntax(format!("line {number}: {word:?} is no number")))
        };
        match (words.first().copied(), rows.last_mut()) {
            (Some("UNIT"), _) => {
                to_mm = match words.get(1).copied() {
                    Some("MM") | None => 1.0,
                    Some("CM") => 10.0,
                    Some("IN") => 25.4,
                    Some("M" | "METER") => 1000.0,
                    Some(other) => return Err(syntax(format!("line {number}: unknown unit {other}"))),
                }
            }
            (Some("NAME"), _) if words.len() > 1 => name = words[1..].join(" "),
            (Some("SURF"), _) => rows.push(Surface::plane(0.0)),
            (Some("STOP"), Some(_)) => stop = Some(rows.len() - 1),
            (Some("TYPE"), Some(_)) => {
                let kind = words.get(1).copied().unwrap_or_default();
                if !["STANDARD", "EVENASPH"].contains(&kind) {
                    return Err(syntax(format!(
                        "line {number}: surfaces of type {kind} are not supported; STANDARD and EVENASPH are"
                    )));
                }
            }
            (Some("CURV"), Some(surface)) => {
                let curvature = value(1)? / to_mm;
                surface.radius_mm = if curvature == 0.0 { 0.0 } else { curvature.recip() };
            }
            (Some("DISZ"), Some(surface)) => surface.thickness_mm = value(1)? * to_mm,
            (Some("DIAM"), Some(surface)) => {
                surface.semi_diameter_mm = Some(value(1)? * to_mm).filter(|&radius| radius > 0.0);
            }
            (Some("CONI"), Some(surface)) => surface.conic = value(1)?,
            (Some("PARM"), Some(surface)) => {
                let (index, coefficient) = (value(1)?, value(2)?);
                if coefficient != 0.0 && (1.0..=20.0).contains(&index) {
                    let index = index as usize;
                    if surface.aspheric.len() < index {
                        surface.aspheric.resize(index, 0.0);
                    }
                    surface.aspheric[index - 1] = coefficient * to_mm.powi(1 - 2 * index as i32);
                }
            }
            (Some("GLAS"), Some(surface)) => {
                let glass = words.get(1).copied().unwrap_or_default();
                if glass == "MIRROR" {
                    return Err(syntax(format!("line {number}: mirrors are not supported")));
                }
                let model = value(2).is_ok_and(|kind| kind == 1.0);
                let (n_d, v_d) = (value(4).unwrap_or(0.0), value(5).unwrap_or(0.0));
                surface.glass = Glass::catalogue(glass)
                    .filter(|_| !model)
                    .unwrap_or_else(|| Glass::model(n_d, v_d));
                if surface.glass.index(super::D_LINE_UM) < 1.0 {
                    return Err(syntax(format!(
                        "line {number}: the glass {glass} is in no catalogue here and has no index; write its n_d and V_d"
                    )));
                }
            }
            _ => {}
        }
    }
    if rows.len() < 4 {
        return Err(syntax("it has no table of surfaces".to_owned()));
    }
    rows.pop();
    rows.remove(0);
    let stop = stop.and_then(|stop: usize| stop.checked_sub(1));
    let source = format!("Zemax file {}", path.display());
    Lens::new(name, source, rows, stop, full_frame())
}
