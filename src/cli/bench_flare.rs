//! `rilievo bench --flare`: what the flares of the built-in lenses cost.

use std::sync::Arc;

use serde_json::{Value, json};

use super::CommandError;
use super::statistics::median;
use crate::camera::flare::{
    Aperture, FlareImager, FlareLight, FlareMode, FlareParameters, FlareRequest, FlareSource, FlareTable,
    GhostParameters, GhostTable, Quality, Tracing, area_on_film, film_half_mm, flare_mesh,
};
use crate::camera::lens::{BUILT_IN, open};
use crate::camera::single_crossing_ghosts;
use crate::gpu::Gpu;
use crate::output::RenderError;
use crate::space::SOLAR_ANGULAR_RADIUS;

/// The f-number of all.
pub(super) const F_NUMBER: f64 = 8.0;
/// The light's angle from the axis and azimuth, radians.
const ANGLE: f64 = 5.0 * std::f64::consts::PI / 180.0;
const AZIMUTH: f64 = 0.5;
/// Rays along a side of a traced grid: where more no longer changes the picture by 40 dB.
const RAYS: usize = 40;

/// Times every built-in lens, or one of any kind, in every mode: triangles, milliseconds to make them, milliseconds on the GPU.
pub fn run(only: Option<&str>, size: [u32; 2], frames: u32, json: bool) -> Result<(), CommandError> {
    let gpu = Gpu::open().map_err(RenderError::from)?;
    let mut imager = FlareImager::new(&gpu);
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
    let names = match only {
        Some(name) => vec![name],
        None => BUILT_IN.map(|(name, _)| name).to_vec(),
    };
    for name in names {
        let lens = Arc::new(open(name)?);
        let ghost_count = single_crossing_ghosts(&lens).len();
        let start = std::time::Instant::now();
        let max_angle = super::lens_flags::max_angle(&lens);
        let table = FlareTable::bake(&lens, F_NUMBER, max_angle);
        let bake_ms = start.elapsed().as_secs_f64() * 1e3;
        let bytes = table.bytes();
        let tabled = table.len();
        let table = Arc::new(GhostTable::of_rays(table));
        let ghosts = |mode, whole_entrance| GhostParameters {
            mode,
            rays: RAYS,
            whole_entrance,
            ..Quality::Medium.preset().ghosts()
        };
        // Raster work of the quads over the whole front of the lens, by that over the effective pupil alone.
        let work = |whole_entrance| -> Result<f64, RenderError> {
            let mesh = flare_mesh(&FlareParameters {
                lens: &lens,
                source: FlareSource {
                    angle: ANGLE,
                    azimuth: AZIMUTH,
                    f_number: F_NUMBER,
                    angular_radius: SOLAR_ANGULAR_RADIUS,
                },
                ghosts: ghosts(FlareMode::Paraxial, whole_entrance),
                table: None,
                tracing: Tracing::Cpu,
            })?;
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
            for frame in 0..frames {
                // The light moves, so that no frame is drawn from another's mesh.
                let request = FlareRequest {
                    lens: Arc::clone(&lens),
                    f_number: F_NUMBER,
                    aperture: Aperture::default(),
                    ghosts: Some(ghosts(mode, false)),
                    starburst: None,
                    table: Some(Arc::clone(&table)),
                    light: FlareLight {
                        angular_radius: SOLAR_ANGULAR_RADIUS,
                        ..FlareLight::point(ANGLE + 1e-5 * f64::from(frame), AZIMUTH)
                    },
                    image_half_mm: film_half_mm(&lens, size),
                };
                let image = imager.draw(&request, size).map_err(RenderError::from)?;
                triangles = image.mesh.triangles;
                times.push((image.mesh.make_ms, image.gpu_ms));
            }
            let make_ms = median(times.iter().map(|(make, _)| *make));
            let gpu_ms = median(times.iter().filter_map(|(_, gpu)| *gpu));
            let a_ghost = gpu_ms.map(|ms| ms / ghost_count as f64);
            let mode = format!("{mode:?}").to_lowercase();
            if !json {
                let ms = |value: Option<f64>| value.map_or("-".to_owned(), |ms| format!("{ms:.2}"));
                say!(
                    "{name:18} {ghost_count:>7} {mode:9} {triangles:>10} {:>9} {:>9} {:>16}",
                    ms(make_ms),
                    ms(gpu_ms),
                    ms(a_ghost)
                );
            }
            if !json && mode == "blended" {
                say!(
                    "{:18} table of {} ghosts, {:.2} MB, baked in {bake_ms:.0} ms; the effective pupil saves {pupil_saving:.1} times the quads' raster work",
                    "",
                    tabled,
                    bytes as f64 * 1e-6
                );
            }
            rows.push(json!({
                "lens": name, "ghosts": ghost_count, "mode": mode, "triangles": triangles,
                "table_bytes": bytes, "bake_ms": bake_ms, "make_ms": make_ms, "gpu_ms": gpu_ms, "gpu_ms_per_ghost": a_ghost,
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
