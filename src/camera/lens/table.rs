//! The project's own lens file: TOML, one line a surface, millimetres.
//!
//! ```toml
//! name = "tessar"
//! source = "the patent or book"
//! film_mm = [36.0, 24.0]
//! surfaces = [
//!   { radius = 22.5851, thickness = 3.5, glass = "LAFN21", n_d = 1.78831, v_d = 47.39, semi_diameter = 11.27686 },
//!   { stop = true, thickness = 4.06086, semi_diameter = 6.01427 },
//!   { radius = -28.85977, thickness = 42.58, conic = -0.4, aspheric = [0.0, 1e-6], coating = { wavelength_nm = 550.0, index = 1.38 } },
//! ]
//! ```
//! A missing radius, 0 or inf is a plane; a missing `n_d` is the catalogue's, without a glass air; `aspheric` are the coefficients of r², r⁴ ...; a coating of
//! several films is `coating = { layers = [{ index = 1.38, thickness_nm = 99.6 }, ...] }`, from the front.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::catalogue::named;
use super::prescription::{full_frame, plane_or};
use super::{Coating, Glass, Layer, Lens, LensError, Surface};

#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    #[serde(default)]
    source: String,
    #[serde(default = "full_frame")]
    film_mm: [f64; 2],
    surfaces: Vec<Row>,
}

#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Row {
    #[serde(default, skip_serializing_if = "is_false")]
    stop: bool,
    #[serde(default, skip_serializing_if = "is_zero")]
    radius: f64,
    thickness: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    glass: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    n_d: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    v_d: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    semi_diameter: Option<f64>,
    #[serde(default, skip_serializing_if = "is_zero")]
    conic: f64,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    aspheric: Vec<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    coating: Option<CoatingRow>,
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(untagged)]
enum CoatingRow {
    QuarterWave { wavelength_nm: f64, index: f64 },
    Layers { layers: Vec<LayerRow> },
}

#[derive(Debug, Deserialize, Serialize)]
struct LayerRow {
    index: f64,
    thickness_nm: f64,
}

fn is_false(value: &bool) -> bool {
    !value
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Reads the text of such a file; `path` is named in errors.
pub fn read(path: &Path, text: &str) -> Result<Lens, LensError> {
    let file: File = toml::from_str(text).map_err(|error| LensError::Syntax {
        path: path.to_owned(),
        what: error.to_string().replace('\n', " "),
    })?;
    let stops: Vec<usize> = file
        .surfaces
        .iter()
        .enumerate()
        .filter_map(|(index, row)| row.stop.then_some(index))
        .collect();
    if stops.len() > 1 {
        return Err(LensError::Unfit {
            name: file.name,
            what: "more than one surface is marked as the stop".to_owned(),
        });
    }
    let surfaces = file
        .surfaces
        .into_iter()
        .map(surface_of)
        .collect::<Result<Vec<_>, _>>()
        .map_err(|what| LensError::Syntax {
            path: path.to_owned(),
            what,
        })?;
    Lens::new(
        file.name,
        file.source,
        surfaces,
        stops.first().copied(),
        file.film_mm,
    )
}

fn surface_of(row: Row) -> Result<Surface, String> {
    let v_d = row.v_d.unwrap_or(0.0);
    Ok(Surface {
        radius_mm: plane_or(row.radius),
        thickness_mm: row.thickness,
        glass: match &row.glass {
            Some(name) => named(name, row.n_d, v_d)?,
            None => Glass::model(row.n_d.unwrap_or(1.0), v_d),
        },
        semi_diameter_mm: row.semi_diameter,
        conic: row.conic,
        aspheric: row.aspheric,
        coating: row.coating.map(|coating| match coating {
            CoatingRow::QuarterWave { wavelength_nm, index } => {
                Coating::quarter_wave(wavelength_nm * 1e-3, index)
            }
            CoatingRow::Layers { layers } => Coating {
                layers: layers
                    .iter()
                    .map(|layer| Layer {
                        index: layer.index,
                        thickness_um: layer.thickness_nm * 1e-3,
                    })
                    .collect(),
            },
        }),
    })
}

/// A lens as the text of such a file.
pub fn to_toml(lens: &Lens) -> String {
    let row = |(index, surface): (usize, &Surface)| {
        let (n_d, v_d) = match &surface.glass {
            Glass::Air => (None, None),
            Glass::Model { n_d, v_d } => (Some(*n_d), (*v_d > 0.0).then_some(*v_d)),
            glass => (Some(glass.index(super::D_LINE_UM)), Some(glass.abbe_number())),
        };
        let row = Row {
            stop: index == lens.stop,
            radius: surface.radius_mm,
            thickness: surface.thickness_mm,
            glass: surface.glass.name().map(str::to_owned),
            n_d,
            v_d,
            semi_diameter: surface.semi_diameter_mm,
            conic: surface.conic,
            aspheric: surface.aspheric.clone(),
            coating: surface.coating.as_ref().map(|coating| CoatingRow::Layers {
                layers: coating
                    .layers
                    .iter()
                    .map(|layer| LayerRow {
                        index: layer.index,
                        thickness_nm: layer.thickness_um * 1e3,
                    })
                    .collect(),
            }),
        };
        // A record of numbers and names is always a table of TOML.
        toml::Value::try_from(row).map_or_else(|error| error.to_string(), |value| value.to_string())
    };
    let rows: Vec<String> = lens.surfaces.iter().enumerate().map(row).collect();
    format!(
        "name = {}\nsource = {}\nfilm_mm = [{:?}, {:?}]\nsurfaces = [\n  {},\n]\n",
        toml::Value::from(lens.name.as_str()),
        toml::Value::from(lens.source.as_str()),
        lens.film_mm[0],
        lens.film_mm[1],
        rows.join(",\n  "),
    )
}
