//! Reads a table of surfaces as comma-separated values: `surf, kind (lens / stop / sensor), radius_mm (0 = plane),
//! thickness_mm, n_d, V_d, semi_diameter_mm, conic, aspheric_even_coeffs (index:value, 1 = r²), coating_lambda_nm,
//! coating_n, glass`. Lines that begin with # are comments; `# film_mm: 36x24` and `# lens: name` are understood.

use std::path::Path;

use serde::Deserialize;

use super::catalogue::named;
use super::prescription::{full_frame, plane_or};
use super::{Coating, D_LINE_UM, Glass, Lens, LensError, Surface};

#[derive(Debug, Deserialize)]
struct Row {
    kind: String,
    radius_mm: f64,
    thickness_mm: f64,
    n_d: Option<f64>,
    #[serde(rename = "V_d")]
    v_d: Option<f64>,
    semi_diameter_mm: Option<f64>,
    conic: Option<f64>,
    aspheric_even_coeffs: Option<String>,
    coating_lambda_nm: Option<f64>,
    coating_n: Option<f64>,
    glass: Option<String>,
}

/// Reads the text of such a file; `path` is named in errors.
pub fn read(path: &Path, text: &str) -> Result<Lens, LensError> {
    let syntax = |what: String| LensError::Syntax {
        path: path.to_owned(),
        what,
    };
    let remark = |key: &str| {
        text.lines()
            .filter_map(|line| line.strip_prefix('#'))
            .filter_map(|line| line.trim().strip_prefix(key)?.strip_prefix(':'))
            .map(|value| value.trim().to_owned())
            .find(|value| !value.is_empty())
    };
    let film_mm = remark("film_mm")
        .and_then(|film| {
            let (width, height) = film.split_once('x')?;
            Some([width.parse().ok()?, height.parse().ok()?])
        })
        .unwrap_or_else(full_frame);
    let name = remark("lens").unwrap_or_else(|| stem(path));
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let (mut surfaces, mut stop) = (Vec::new(), None);
    for row in reader.deserialize::<Row>() {
        let row = row.map_err(|error| syntax(error.to_string()))?;
        match row.kind.as_str() {
            "sensor" => break,
            "stop" if stop.is_some() => return Err(syntax("more than one row is the stop".to_owned())),
            "stop" => stop = Some(surfaces.len()),
            "lens" => {}
            other => {
                return Err(syntax(format!(
                    "the kind {other:?} is none of lens, stop, sensor"
                )));
            }
        }
        surfaces.push(surface_of(&row).map_err(syntax)?);
    }
    // The tables name a film on every row; there is none in cement.
    for k in 1..surfaces.len() {
        let is_glass =
            |surface: &Surface| surface.glass != Glass::Air && surface.glass.index(D_LINE_UM) > 1.01;
        if is_glass(&surfaces[k - 1]) && is_glass(&surfaces[k]) {
            surfaces[k].coating = None;
        }
    }
    Lens::new(
        name,
        remark("source").unwrap_or_default(),
        surfaces,
        stop,
        film_mm,
    )
}

fn surface_of(row: &Row) -> Result<Surface, String> {
    let v_d = row.v_d.unwrap_or(0.0);
    let mut aspheric = Vec::new();
    let pairs = row.aspheric_even_coeffs.as_deref().unwrap_or_default();
    for pair in pairs.split([' ', ';', '|']).filter(|pair| !pair.is_empty()) {
        let (index, value) = pair
            .split_once(':')
            .and_then(|(index, value)| Some((index.parse::<usize>().ok()?, value.parse::<f64>().ok()?)))
            .filter(|(index, _)| (1..=20).contains(index))
            .ok_or_else(|| format!("the aspheric coefficient {pair:?} is not index:value"))?;
        if aspheric.len() < index {
            aspheric.resize(index, 0.0);
        }
        aspheric[index - 1] = value;
    }
    let coating = match (row.coating_lambda_nm, row.coating_n) {
        (Some(wavelength_nm), Some(index)) if wavelength_nm > 0.0 && index > 0.0 => {
            Some(Coating::quarter_wave(wavelength_nm * 1e-3, index))
        }
        _ => None,
    };
    let name = row.glass.as_deref().filter(|name| !name.is_empty());
    Ok(Surface {
        radius_mm: plane_or(row.radius_mm),
        thickness_mm: row.thickness_mm,
        glass: match name {
            Some(name) => named(name, row.n_d, v_d)?,
            None => Glass::model(row.n_d.unwrap_or(1.0), v_d),
        },
        semi_diameter_mm: row.semi_diameter_mm.filter(|&radius| radius > 0.0),
        conic: row.conic.unwrap_or(0.0),
        aspheric,
        coating,
    })
}

/// A file's name without its ending.
pub fn stem(path: &Path) -> String {
    path.file_stem()
        .map(|stem| stem.to_string_lossy().into_owned())
        .unwrap_or_default()
}
