//! Reads a CODE V sequence file (.seq): `S radius thickness glass` lines with STO, CIR, K and A to J. The first surface (`SO`,
//! `S0` or the first `S`) is the object and `SI` the image; both are left out. Statements end at a line's end or at a semicolon;
//! what names a surface (`THI S3 9`) changes it, else the last one.

use std::path::Path;

use super::catalogue::{find, from_code, has_catalogue};
use super::csv::stem;
use super::prescription::{full_frame, plane_or};
use super::{Glass, Lens, LensError, Surface};

/// Statements that give a surface a shape or place this reader does not know.
const UNKNOWN_SHAPES: [&str; 26] = [
    "ADE", "BDE", "CDE", "XDE", "YDE", "ZDE", "DAR", "BEN", "REV", "RET", "GLB", "CYL", "YTO", "XTO", "RDX",
    "CUX", "SPS", "DIF", "GRT", "HOE", "SPL", "ARR", "NSS", "FRE", "UDS", "XAS",
];

/// Reads the text of such a file; `path` is named in errors.
pub fn read(path: &Path, text: &str) -> Result<Lens, LensError> {
    let syntax = |what: String| LensError::Syntax {
        path: path.to_owned(),
        what,
    };
    let mut file = File {
        to_mm: 1.0,
        radii: false,
        name: stem(path),
        rows: Vec::new(),
        stop: None,
        is_done: false,
    };
    for (number, words) in statements(text) {
        file.statement(&words)
            .map_err(|why| syntax(format!("line {number}: {why}")))?;
    }
    let File { mut rows, stop, .. } = file;
    if rows.len() < 4 {
        return Err(syntax(
            "it has no table of surfaces from SO (object) to SI (image)".to_owned(),
        ));
    }
    rows.pop();
    rows.remove(0);
    let stop = stop.and_then(|stop: usize| stop.checked_sub(1));
    let source = format!("CODE V file {}", path.display());
    Lens::new(file.name, source, rows, stop, full_frame())
}

/// What has been read.
struct File {
    to_mm: f64,
    /// Shapes are radii, not curvatures.
    radii: bool,
    name: String,
    rows: Vec<Surface>,
    stop: Option<usize>,
    /// The image has been read.
    is_done: bool,
}

/// Words of each statement with the number of its line: lines that end in & go on in the next, ! begins a remark, and quotes
/// hold words together.
fn statements(text: &str) -> Vec<(usize, Vec<String>)> {
    let mut all = Vec::new();
    let mut words: Vec<String> = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let (mut word, mut quote) = (String::new(), None);
        for letter in line.chars() {
            match (quote, letter) {
                (Some(open), _) if letter == open => quote = None,
                (None, '\'' | '"') => quote = Some(letter),
                (None, '!') => break,
                (None, ';') => {
                    words.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
                    all.push((number, std::mem::take(&mut words)));
                }
                (None, _) if letter.is_whitespace() => {
                    words.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
                }
                _ => word.push(letter),
            }
        }
        words.extend((!word.is_empty()).then_some(word));
        if words.last().is_some_and(|word| word == "&") {
            words.pop();
        } else {
            all.push((number, std::mem::take(&mut words)));
        }
    }
    all.push((text.lines().count(), words));
    all.retain(|(_, words)| !words.is_empty());
    all
}

impl File {
    fn statement(&mut self, words: &[String]) -> Result<(), String> {
        let code = words[0].to_uppercase();
        let upper = |at: usize| words.get(at).map(|word| word.to_uppercase()).unwrap_or_default();
        if let Some(surface) = self.new_surface(&code) {
            return self.add(surface, words);
        }
        let is_numbered = code
            .strip_prefix('S')
            .is_some_and(|number| number.parse::<usize>().is_ok());
        if is_numbered {
            return Err(format!(
                "{code} is not the next surface, which would be S{}; change one with RDY, THI or GLA",
                self.rows.len()
            ));
        }
        if UNKNOWN_SHAPES.contains(&code.as_str()) {
            return Err(format!(
                "{code} is not supported; lenses of spheres, conics and even aspheres on one axis are"
            ));
        }
        match code.as_str() {
            // `RDM;LEN`: a table of radii; without it, of curvatures.
            "RDM" => self.radii = !["N", "NO"].contains(&upper(1).as_str()),
            "TITLE" | "TIT" => self.name = words[1..].join(" "),
            "DIM" => {
                self.to_mm = match upper(1).as_str() {
                    "M" | "MM" | "" => 1.0,
                    "C" | "CM" => 10.0,
                    "I" | "IN" | "INCH" => 25.4,
                    other => return Err(format!("unknown unit {other}; M (mm), C or I are known")),
                }
            }
            "THI" | "RDY" | "CUY" | "GLA" | "GL1" | "STO" | "CIR" | "K" | "A" | "B" | "C" | "D" | "E"
            | "F" | "G" | "H" | "J" => self.change(&code, words)?,
            _ => {}
        }
        Ok(())
    }

    /// Whether a statement begins a surface: `S`, `SO`, `SI`, or `Sn` with the next number.
    fn new_surface(&self, code: &str) -> Option<bool> {
        let number = code.strip_prefix('S')?;
        let is_next = number
            .parse::<usize>()
            .is_ok_and(|number| number == self.rows.len());
        (["", "O", "I"].contains(&number) || is_next).then_some(number == "I")
    }

    fn number(words: &[String], at: usize) -> Result<f64, String> {
        let word = words.get(at).map(String::as_str).unwrap_or_default();
        word.parse().map_err(|_| format!("{word:?} is no number"))
    }

    fn radius_mm(&self, shape: f64) -> f64 {
        match shape {
            0.0 => 0.0,
            _ if self.radii => plane_or(shape * self.to_mm),
            _ => self.to_mm / shape,
        }
    }

    fn add(&mut self, is_image: bool, words: &[String]) -> Result<(), String> {
        if self.is_done {
            return Ok(());
        }
        self.is_done = is_image;
        let optional = |at: usize| {
            if words.len() > at {
                Self::number(words, at)
            } else {
                Ok(0.0)
            }
        };
        let (shape, thickness) = (optional(1)?, optional(2)?);
        if words[1.min(words.len())..]
            .iter()
            .any(|word| word.eq_ignore_ascii_case("REFL"))
        {
            return Err("mirrors are not supported".to_owned());
        }
        self.rows.push(Surface {
            radius_mm: self.radius_mm(shape),
            glass: glass_of(words.get(3).map(String::as_str).unwrap_or_default())?,
            ..Surface::plane(thickness * self.to_mm)
        });
        Ok(())
    }

    /// A statement about the surface it names, else about the last one.
    fn change(&mut self, code: &str, words: &[String]) -> Result<(), String> {
        let last = self
            .rows
            .len()
            .checked_sub(1)
            .ok_or("it stands before any surface")?;
        let named = words.get(1).and_then(|word| {
            let place = word.to_uppercase();
            match place.strip_prefix('S')? {
                "O" => Some(0),
                "I" => Some(last),
                number => number.parse().ok(),
            }
        });
        let at = named.unwrap_or(last);
        let first = 1 + usize::from(named.is_some());
        let value = || Self::number(words, first);
        let to_mm = self.to_mm;
        let Some(surface) = self.rows.get_mut(at) else {
            return Err(format!("there is no surface {at} yet"));
        };
        match code {
            "STO" => self.stop = Some(at),
            "THI" => surface.thickness_mm = value()? * to_mm,
            "RDY" => surface.radius_mm = plane_or(value()? * to_mm),
            "CUY" => surface.radius_mm = plane_or(to_mm / value()?),
            "GLA" | "GL1" => {
                surface.glass = glass_of(words.get(first).map(String::as_str).unwrap_or_default())?;
            }
            // `CIR OBS` is an obscuration and `CIR EDG` the edge of the glass.
            "CIR" => match Self::number(words, first) {
                Ok(radius) => surface.semi_diameter_mm = Some(radius * to_mm),
                Err(why) if words.len() <= first => return Err(why),
                Err(_) => {}
            },
            "K" => surface.conic = value()?,
            // A is the coefficient of r⁴, B of r⁶ and so on.
            letter => {
                let order = "ABCDEFGHJ".find(letter).unwrap_or(0) + 2;
                if surface.aspheric.len() < order {
                    surface.aspheric.resize(order, 0.0);
                }
                surface.aspheric[order - 1] = value()? * to_mm.powi(1 - 2 * order as i32);
            }
        }
        Ok(())
    }
}

/// A glass by name (`NBK7_SCHOTT`), by code (`517642`, `516800.641673`) or as `1.5168:64.17`.
fn glass_of(word: &str) -> Result<Glass, String> {
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
    if let Some((n_d, v_d)) = word.split_once(':')
        && let (Ok(n_d), Ok(v_d)) = (n_d.parse(), v_d.parse())
    {
        return Ok(Glass::model(n_d, v_d));
    }
    if let Some(glass) = from_code(word) {
        return Ok(glass);
    }
    let (name, maker) = word.split_once('_').unwrap_or((word, ""));
    if !maker.is_empty() && !has_catalogue(maker) {
        return Err(unknown());
    }
    find(name, &[maker], None).ok_or_else(unknown)
}
