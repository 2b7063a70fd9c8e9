//! Reads a CODE V sequence file (.seq): `S radius thickness glass` lines with STO, CIR, K and A to J. `SO` (or the first S)
//! is the object and `SI` the image; both are left out. Statements end at a line's end or at a semicolon.

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
    let mut radii = false;
    let mut name = stem(path);
    let mut rows: Vec<Surface> = Vec::new();
    let (mut stop, mut with_object) = (None, false);
    // A line that ends in & goes on in the next.
    let joined = text.replace("&\r\n", " ").replace("&\n", " ");
    let statements = (1..).zip(joined.lines()).flat_map(|(number, line)| {
        let line = line.split('!').next().unwrap_or_default();
        line.split(';').map(move |statement| (number, statement))
    });
    for (number, statement) in statements {
        let words: Vec<&str> = statement.split_whitespace().collect();
        let Some(&first) = words.first() else { continue };
        let value = |at: usize| -> Result<f64, LensError> {
            let word = words.get(at).copied().unwrap_or_default();
            word.parse()
                .map_err(|_| syntax(format!("line {number}: {word:?} is no number")))
        };
        match (first.to_uppercase().as_str(), rows.last_mut()) {
            // `RDM;LEN`: a table of radii; without it, of curvatures.
            ("RDM", _) => radii = words.get(1).is_none_or(|word| !word.eq_ignore_ascii_case("N")),
            ("TITLE", _) => name = words[1..].join(" ").trim_matches(['\'', '"']).to_owned(),
            ("DIM", _) => {
                to_mm = match words.get(1).map(|unit| unit.to_uppercase()).as_deref() {
                    Some("C") => 10.0,
                    Some("I") => 25.4,
                    _ => 1.0,
                }
            }
            (code @ ("S" | "SO" | "S0" | "SI"), _) => {
                with_object |= code == "SO" || code == "S0";
                let (shape, thickness) = (value(1)?, value(2).unwrap_or(0.0));
                let radius = match shape {
                    0.0 => 0.0,
                    _ if radii => shape * to_mm,
                    _ => to_mm / shape,
                };
                let glass = words.get(3).copied().unwrap_or_default();
                let glass = glass_of(glass).map_err(|why| syntax(format!("line {number}: {why}")))?;
                rows.push(Surface {
                    radius_mm: radius,
                    glass,
                    ..Surface::plane(thickness * to_mm)
                });
            }
            ("STO", Some(_)) => stop = Some(rows.len() - 1),
            ("CIR", Some(surface)) => surface.semi_diameter_mm = Some(value(words.len() - 1)? * to_mm),
            ("K", Some(surface)) => surface.conic = value(1)?,
            // A is the coefficient of r⁴, B of r⁶ and so on.
            (letter @ ("A" | "B" | "C" | "D" | "E" | "F" | "G" | "H" | "J"), Some(surface)) => {
                let order = "ABCDEFGHJ".find(letter).unwrap_or(0) + 2;
                if surface.aspheric.len() < order {
                    surface.aspheric.resize(order, 0.0);
                }
                surface.aspheric[order - 1] = value(1)? * to_mm.powi(1 - 2 * order as i32);
            }
            _ => {}
        }
    }
    if rows.len() < 4 || !with_object {
        return Err(syntax(
            "it has no table of surfaces from SO (object) to SI (image)".to_owned(),
        ));
    }
    rows.pop();
    rows.remove(0);
    let stop = stop.and_then(|stop: usize| stop.checked_sub(1));
    let source = format!("CODE V file {}", path.display());
    Lens::new(name, source, rows, stop, full_frame())
}

/// A glass by name (`NBK7_SCHOTT`), by code (`517642`, `516800.641673`) or as `1.5168:64.17`.
fn glass_of(word: &str) -> Result<Glass, String> {
    let model = |n_d: &str, v_d: &str| Some((n_d.parse::<f64>().ok()?, v_d.parse::<f64>().ok()?));
    let unknown = || {
        format!(
            "the glass {word} is in no catalogue here; write it as a code like 516800.641673 (n_d - 1, V_d)"
        )
    };
    if word.is_empty() || word.eq_ignore_ascii_case("AIR") {
        return Ok(Glass::Air);
    }
    if word.eq_ignore_ascii_case("REFL") {
        return Err("mirrors are not supported".to_owned());
    }
    if let Some((n_d, v_d)) = word.split_once(':').and_then(|(n_d, v_d)| model(n_d, v_d)) {
        return Ok(Glass::model(n_d, v_d));
    }
    if word.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.') {
        // Digits before the point are those of n_d - 1, after it those of V_d with two before its own point.
        let (index, abbe) = match word.split_once('.') {
            Some((index, abbe)) => (index.to_owned(), abbe.to_owned()),
            None if word.len() == 6 => (word[..3].to_owned(), word[3..].to_owned()),
            None => return Err(unknown()),
        };
        if abbe.len() < 2 {
            return Err(unknown());
        }
        let abbe = format!("{}.{}", &abbe[..2], &abbe[2..]);
        return model(&format!("1.{index}"), &abbe)
            .map(|(n_d, v_d)| Glass::model(n_d, v_d))
            .ok_or_else(unknown);
    }
    let name = word.split('_').next().unwrap_or(word);
    Glass::catalogue(name).ok_or_else(unknown)
}
