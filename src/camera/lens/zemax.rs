//! Reads a Zemax sequential lens file (.zmx): blocks of `SURF n` with TYPE, CURV, DISZ, GLAS, DIAM, CONI, PARM and STOP.
//! Surface 0 is the object and the last one the image; both are left out.

use std::path::Path;

use super::catalogue::{find, from_code, is_of, is_placeholder};
use super::csv::stem;
use super::prescription::full_frame;
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
    let mut catalogues: Vec<String> = Vec::new();
    // Surfaces at an infinite distance from the next: the object may be one.
    let mut endless = Vec::new();
    let mut stop = None;
    for (number, line) in (1..).zip(text.lines()) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let value = |at: usize| -> Result<f64, LensError> {
            let word = words.get(at).copied().unwrap_or_default();
            if word == "INFINITY" {
                return Ok(0.0);
            }
            // Some systems write decimal commas.
            word.replace(',', ".")
                .parse()
                .map_err(|_| syntax(format!("line {number}: {word:?} is no number")))
        };
        match (words.first().copied(), rows.last_mut()) {
            (Some("UNIT"), _) => {
                to_mm = match words.get(1).copied() {
                    Some("MM") | None => 1.0,
                    Some("CM") => 10.0,
                    Some("IN" | "INCH") => 25.4,
                    Some("M" | "METER") => 1000.0,
                    Some(other) => return Err(syntax(format!("line {number}: unknown unit {other}"))),
                }
            }
            (Some("NAME"), _) if words.len() > 1 => name = words[1..].join(" "),
            (Some("GCAT"), _) => {
                catalogues = words[1..].iter().map(|&word| word.to_owned()).collect();
            }
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
            (Some("DISZ"), Some(_)) => {
                if words.get(1) == Some(&"INFINITY") {
                    endless.push((rows.len() - 1, number));
                }
                let thickness_mm = value(1)? * to_mm;
                if let Some(surface) = rows.last_mut() {
                    surface.thickness_mm = thickness_mm;
                }
            }
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
                let is_model = value(2).is_ok_and(|kind| kind == 1.0);
                let (n_d, v_d) = (value(4).unwrap_or(0.0), value(5).unwrap_or(0.0));
                let stated = (!is_placeholder(n_d, v_d)).then_some(n_d);
                let makers: Vec<&str> = catalogues.iter().map(String::as_str).collect();
                let is_near = |glass: &Glass, n_d: f64| (glass.index(super::D_LINE_UM) - n_d).abs() < 1e-3;
                // A maker that the file does not name counts only where the stated index is its glass's.
                let found = find(glass, &makers, stated)
                    .filter(|glass| is_of(glass, &makers) || stated.is_none_or(|n_d| is_near(glass, n_d)))
                    .or_else(|| from_code(glass))
                    .filter(|_| !is_model);
                surface.glass = match (found, stated) {
                    (Some(glass), _) => glass,
                    (None, Some(n_d)) => Glass::model(n_d, v_d),
                    (None, None) if is_model && n_d > 0.0 => Glass::model(n_d, v_d),
                    (None, None) => {
                        return Err(syntax(format!(
                            "line {number}: the glass {glass} is in no catalogue here and its index is not stated; write \
                             its n_d and V_d instead (GLAS ___BLANK 1 0 n_d V_d)"
                        )));
                    }
                };
            }
            _ => {}
        }
    }
    let last = rows.len().saturating_sub(1);
    if let Some((surface, number)) = endless
        .iter()
        .find(|(surface, _)| *surface > 0 && *surface < last)
    {
        return Err(syntax(format!(
            "line {number}: surface {surface} is infinitely far from the next"
        )));
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
