//! `rilievo lens trace`: one exact ray.

use glam::DVec2;
use serde_json::json;

use super::CommandError;
use super::lens_flags::ghost_of;
use crate::camera::lens::{D_LINE_UM, open};
use crate::camera::{Bundle, Paraxial, RayPass, Tracer, beam_direction};
use crate::gpu::Gpu;
use crate::output::RenderError;

/// Flags of `lens trace`.
#[derive(Debug, clap::Args)]
pub struct TraceArgs {
    /// A built-in name or a file.
    lens: String,
    /// Reflect at surface I, then at J (numbered from 1, the stop counted); without it, the image's ray.
    #[arg(long, value_parser = super::lens_flags::pair)]
    ghost: Option<[usize; 2]>,
    /// Angle of the beam from the axis, degrees: its direction is (sin, 0, cos).
    #[arg(long, allow_hyphen_values = true)]
    angle: f64,
    /// Where the ray crosses the plane of the first vertex: X,Y in millimetres.
    #[arg(long, value_parser = super::lens_flags::millimetres, allow_hyphen_values = true)]
    entry: DVec2,
    /// Wavelength, nanometres [default: the d line].
    #[arg(long)]
    wavelength: Option<f64>,
    /// Sensor behind the last vertex, millimetres, or `file` for the file's own gap [default: the paraxial focus].
    #[arg(long, allow_hyphen_values = true)]
    sensor: Option<String>,
    /// Trace on the GPU in f32, not on the CPU in f64.
    #[arg(long)]
    gpu: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Traces and prints.
pub fn run(args: &TraceArgs) -> Result<(), CommandError> {
    let lens = &open(&args.lens)?;
    let ghost = args.ghost.map(|pair| ghost_of(lens, pair)).transpose()?;
    let bad = |what: String| Err(CommandError::Argument(what));
    if !args.angle.is_finite() || args.angle.abs() >= 90.0 {
        return bad(format!("--angle {}: give degrees between -90 and 90", args.angle));
    }
    let wavelength_um = args.wavelength.map_or(D_LINE_UM, |nm| nm * 1e-3);
    if !(0.2..=3.0).contains(&wavelength_um) {
        return bad("--wavelength: give 200 to 3000 nanometres".to_owned());
    }
    let gap = match args.sensor.as_deref() {
        None => Paraxial::new(lens, D_LINE_UM, None).sensor_gap_mm(),
        Some("file") => lens.surfaces[lens.surfaces.len() - 1].thickness_mm,
        Some(text) => match text.parse::<f64>() {
            Ok(gap) if gap.is_finite() => gap,
            _ => return bad(format!("--sensor {text}: give millimetres, or `file`")),
        },
    };
    let angle = args.angle.to_radians();
    let ray = if args.gpu {
        let gpu = Gpu::open().map_err(RenderError::from)?;
        // A grid of two by two rays, of which the first is asked for.
        let bundle = Bundle {
            ghost,
            wavelength_um,
            angle,
            min: args.entry,
            max: args.entry,
        };
        let grids = RayPass::new(&gpu)
            .trace(&gpu, lens, gap, &[bundle], 2)
            .map_err(RenderError::from)?;
        grids[0][0]
    } else {
        Tracer::new(lens, wavelength_um, gap).trace(ghost, args.entry, beam_direction(angle))
    };
    let report = match ray {
        Some(ray) => json!({
            "stop_mm": ray.stop_mm.to_array(),
            "sensor_mm": ray.sensor_mm.to_array(),
            "alive": ray.is_alive(),
            "relative_height": ray.relative_height,
            "power": ray.power,
            "sensor_gap_mm": gap,
        }),
        None => json!({
            "stop_mm": null, "sensor_mm": null, "alive": false, "relative_height": null, "power": 0.0,
            "sensor_gap_mm": gap,
        }),
    };
    if args.json {
        say!("{report}");
        return Ok(());
    }
    match ray {
        None => say!("the ray misses a surface or is reflected totally"),
        Some(ray) => {
            say!("stop   {:.6}, {:.6} mm", ray.stop_mm.x, ray.stop_mm.y);
            say!("sensor {:.6}, {:.6} mm", ray.sensor_mm.x, ray.sensor_mm.y);
            say!(
                "{}; at most {:.3} of a clear radius, the stop apart",
                if ray.is_alive() {
                    "arrives"
                } else {
                    "is held by the barrel or the stop"
                },
                ray.relative_height
            );
        }
    }
    Ok(())
}
