//! `rilievo relief --figures`: the figures of KR 10-0738500 on one sheet.

use std::path::Path;

use super::CommandError;
use super::camera_flags::sun;
use super::default_views::{DEFAULT_FOV_DEG, default_views};
use crate::camera::Camera;
use crate::city::City;
use crate::gpu::Gpu;
use crate::output::{FrameRequest, RenderError, Renderer, write_png};
use crate::relief::extrusion::{FIGURES, draw_figure};
use crate::relief::{Layers, ReliefMode, ReliefSettings, SearchParameters};
use crate::scene::PoolOptions;

/// Figures in a row; with those of a city there are ten.
const COLUMNS: [usize; 2] = [4, 5];
/// Pixels between them.
const GAP: usize = 6;
/// Samples and slices of a city's.
const SAMPLES: u32 = 4;
const SLICES: u32 = 256;

/// Draws and writes; figure 17 is of a city.
pub fn run(city: Option<&Path>, size: [u32; 2], out: &Path) -> Result<(), CommandError> {
    let gpu = Gpu::open().map_err(RenderError::from)?;
    let mut images = Vec::new();
    for figure in &FIGURES {
        eprintln!("figure {}: {}", figure.name, figure.shows);
        images.push(draw_figure(&gpu, figure, size).map_err(RenderError::from)?);
    }
    let columns = COLUMNS[usize::from(city.is_some())];
    if let Some(folder) = city {
        images.extend(of_city(gpu, &City::open(folder)?, size)?);
    }
    let [width, height] = size.map(|side| side as usize);
    let rows = images.len().div_ceil(columns);
    let sheet = [columns * (width + GAP) - GAP, rows * (height + GAP) - GAP];
    let mut pixels = vec![255_u8; 4 * sheet[0] * sheet[1]];
    for (index, image) in images.iter().enumerate() {
        let (column, row) = (index % columns, index / columns);
        for (line, source) in image.chunks_exact(4 * width).enumerate() {
            let place = 4 * ((row * (height + GAP) + line) * sheet[0] + column * (width + GAP));
            pixels[place..place + source.len()].copy_from_slice(source);
        }
    }
    Ok(write_png(out, sheet.map(|side| side as u32), &pixels)?)
}

/// Figure 17: a city whose terrain the global map displaces, without the local map and with it.
fn of_city(gpu: Gpu, city: &City, size: [u32; 2]) -> Result<Vec<Vec<u8>>, CommandError> {
    let mut renderer = Renderer::open(gpu, city, PoolOptions::default())?;
    let sun = sun(None, city.manifest().place)?;
    let views = default_views(city, size)?;
    let Some(view) = views.iter().find(|view| view.name == "oblique") else {
        return Ok(Vec::new());
    };
    let camera = Camera::pinhole(view.pose(), DEFAULT_FOV_DEG.to_radians());
    let figures = [
        ("17, its terrain alone", "displaced by the DTM", false),
        (
            "17",
            "dual displacement: buildings by the building map over it",
            true,
        ),
    ];
    let mut images = Vec::new();
    for (name, shows, buildings) in figures {
        eprintln!("figure {name}: {shows}");
        let request = FrameRequest {
            camera: &camera,
            sun: &sun,
            size,
            relief: ReliefSettings {
                mode: ReliefMode::Search,
                search: SearchParameters {
                    slices: SLICES,
                    ..SearchParameters::default()
                },
                layers: Layers {
                    buildings,
                    ..Layers::default()
                },
            },
            flare: None,
            exposure: 1.0,
        };
        images.push(renderer.still(&request, SAMPLES)?.rgba);
    }
    Ok(images)
}
