//! `rilievo bench --flare`: what the flares of the built-in lenses cost.

use serde_json::{Value, json};

use super::CommandError;
use super::statistics::median;
use crate::camera::flare::{
    Aperture, Blend, Fit, FlareMode, FlareParameters, FlareSource, FlareTable, Pattern, flare_mesh,
};
use crate::camera::lens::{BUILT_IN, built_in};
use crate::camera::single_crossing_ghosts;
use crate::gpu::Gpu;
use crate::output::{FlareRenderer, RenderError, area_on_film, film_half_mm};

/// The f-number of all.
const F_NUMBER: f64 = 8.0;
/// Rays along a side of a traced grid: where more no longer changes the picture by 40 dB.
const RAYS: usize = 40;

/// Times every lens in every mode: triangles, milliseconds to make them, milliseconds on the GPU.
pub fn run(size: [u32; 2], frames: u32, json: bool) -> Result<(), CommandError> {
    let gpu = Gpu::open().map_err(RenderError::from)?;
    let renderer = FlareRenderer::new(&gpu, &Aperture::default());
    let mut rows: Vec<Value> = Vec::new();
    if !json {
        say!("{}, {} x {} pixels", gpu.adapter_name, size[0], size[1]);
        say!(
            "{:18} {:>7} {:9} {:>10} {:>9} {:>9} {:>16}",
            "lens",
            "ghosts",
            "mode",
            "triangles",
            "make ms",
            "GPU ms",
            "GPU ms a ghost"
        );
    }
    for (name, _) in BUILT_IN {
        let Some(lens) = built_in(name) else { continue };
        let lens = lens?;
        let ghosts = single_crossing_ghosts(&lens).len();
        let start = std::time::Instant::now();
        let max_angle = super::lens_flags::max_angle(&lens);
        let table = FlareTable::bake(&lens, F_NUMBER, max_angle).map_err(RenderError::from)?;
        let bake_ms = start.elapsed().as_secs_f64() * 1e3;
        let parameters = |mode, whole_entrance| FlareParameters {
            lens: &lens,
            source: FlareSource {
                angle: 5_f64.to_radians(),
                turn: 0.5,
                irradiance: [1.0; 3],
                f_number: F_NUMBER,
                wavelengths: 3,
                rays: RAYS,
                whole_entrance,
            },
            mode,
            only: None,
            pattern: Pattern::Whole,
            table: Some(&table),
            blend: Blend::Add,
            fit: Fit::default(),
            tracing: renderer.tracing(),
        };
        // Raster work of the quads over the whole front of the lens, by that over the effective pupil alone.
        let work = |whole_entrance| -> Result<f64, RenderError> {
            let mesh = flare_mesh(&parameters(FlareMode::Paraxial, whole_entrance))?;
            Ok(area_on_film(&mesh.added, film_half_mm(&lens, size)))
        };
        let pupil_saving = work(true)? / work(false)?;
        for mode in [
            FlareMode::Paraxial,
            FlareMode::TwoRays,
            FlareMode::Blended,
            FlareMode::Exact,
        ] {
            let mut times = Vec::new();
            let mut triangles = 0;
            for _ in 0..frames {
                let picture = renderer.picture(&parameters(mode, false), None, size)?;
                triangles = picture.triangles;
                times.push((picture.mesh_ms, picture.gpu_ms));
            }
            let make_ms = median(times.iter().map(|(make, _)| *make));
            let gpu_ms = median(times.iter().filter_map(|(_, gpu)| *gpu));
            let a_ghost = gpu_ms.map(|ms| ms / ghosts as f64);
            let mode = format!("{mode:?}").to_lowercase();
            if !json {
                let ms = |value: Option<f64>| value.map_or("-".to_owned(), |ms| format!("{ms:.2}"));
                say!(
                    "{name:18} {ghosts:>7} {mode:9} {triangles:>10} {:>9} {:>9} {:>16}",
                    ms(make_ms),
                    ms(gpu_ms),
                    ms(a_ghost)
                );
            }
            if !json && mode == "blended" {
                say!(
                    "{:18} table of {} ghosts, {:.2} MB, baked in {bake_ms:.0} ms; the effective pupil saves {pupil_saving:.1} times the quads' raster work",
                    "",
                    table.len(),
                    table.bytes() as f64 * 1e-6
                );
            }
            rows.push(json!({
                "lens": name, "ghosts": ghosts, "mode": mode, "triangles": triangles,
                "table_bytes": table.bytes(), "bake_ms": bake_ms, "make_ms": make_ms, "gpu_ms": gpu_ms, "gpu_ms_per_ghost": a_ghost,
                "pupil_saving": pupil_saving,
            }));
        }
    }
    if json {
        say!(
            "{}",
            json!({"device": gpu.adapter_name, "size": size, "frames": frames, "flares": rows})
        );
    }
    Ok(())
}
