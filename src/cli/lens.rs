//! `rilievo lens`: prescriptions, their first-order data, ghosts, rays and drawings.

use std::path::PathBuf;

use glam::{DMat2, DVec2};
use serde_json::{Value, json};

use super::CommandError;
use super::lens_flags::ghost_of;
use crate::camera::lens::{BUILT_IN, D_LINE_UM, Lens, built_in, open, to_toml};
use crate::camera::{
    Ghost, Paraxial, Tracer, beam_direction, crossings, ghosts, lens_diagram, single_crossing_ghosts,
};
use crate::output::write_drawing;

/// What to do with lenses.
#[derive(Debug, clap::Subcommand)]
pub enum LensCommand {
    /// The built-in lenses.
    List,
    /// First-order data: focal length, back focus, stop, f-number, number of ghosts.
    Show {
        /// A built-in name, or a .toml, .csv, .zmx, .seq or .dat file.
        lens: String,
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
        /// Print the lens as the project's own file, to edit or keep.
        #[arg(long, conflicts_with = "json")]
        toml: bool,
    },
    /// A section with traced rays.
    Diagram {
        /// A built-in name or a file.
        lens: String,
        /// Angles of the beams, degrees.
        #[arg(
            long,
            value_delimiter = ',',
            default_value = "0,5,10",
            allow_hyphen_values = true
        )]
        angles: Vec<f64>,
        /// Draw this ghost's rays too: I,J.
        #[arg(long, value_parser = super::lens_flags::pair)]
        ghost: Option<[usize; 2]>,
        /// The drawing to write, .svg or .png.
        #[arg(long)]
        out: PathBuf,
    },
    /// A picture of the flare of the sun.
    Flare(super::lens_flare::FlareArgs),
    /// The nonlinear ghosts recorded beforehand: traced, drawn, or from photos.
    Bake(super::lens_bake::BakeArgs),
    /// All two-reflection ghosts with their matrices.
    Ghosts {
        /// A built-in name or a file.
        lens: String,
        /// Print one JSON list.
        #[arg(long)]
        json: bool,
    },
    /// One exact ray.
    Trace {
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
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
}

/// Runs a lens command.
pub fn run(command: LensCommand) -> Result<(), CommandError> {
    match command {
        LensCommand::List => list(),
        LensCommand::Show { lens, json, toml } => show(&open(&lens)?, json, toml),
        LensCommand::Diagram {
            lens,
            angles,
            ghost,
            out,
        } => {
            let lens = open(&lens)?;
            let ghost = ghost.map(|pair| ghost_of(&lens, pair)).transpose()?;
            let radians: Vec<f64> = angles.iter().map(|angle| angle.to_radians()).collect();
            let svg = lens_diagram(&lens, D_LINE_UM, &radians, ghost);
            write_drawing(&out, &svg)?;
            Ok(())
        }
        LensCommand::Flare(args) => super::lens_flare::run(&args),
        LensCommand::Bake(args) => super::lens_bake::run(&args),
        LensCommand::Ghosts { lens, json } => list_ghosts(&open(&lens)?, json),
        LensCommand::Trace {
            lens,
            ghost,
            angle,
            entry,
            wavelength,
            sensor,
            json,
        } => {
            let lens = open(&lens)?;
            let ghost = ghost.map(|pair| ghost_of(&lens, pair)).transpose()?;
            trace(&lens, ghost, angle, entry, wavelength, sensor.as_deref(), json)
        }
    }
}

fn list() -> Result<(), CommandError> {
    for (name, _) in BUILT_IN {
        let Some(lens) = built_in(name) else { continue };
        let lens = lens?;
        let paraxial = Paraxial::new(&lens, D_LINE_UM, None);
        say!(
            "{name:18} {:7.2} mm  {:2} surfaces  {}",
            paraxial.efl_mm,
            lens.surfaces.len() - 1,
            lens.source
        );
    }
    Ok(())
}

fn show(lens: &Lens, json: bool, toml: bool) -> Result<(), CommandError> {
    if toml {
        say!("{}", to_toml(lens).trim_end());
        return Ok(());
    }
    let paraxial = Paraxial::new(lens, D_LINE_UM, None);
    let pupil = paraxial.entrance_pupil(lens.clear_radius(lens.stop));
    let f_number = paraxial.efl_mm.abs() / (2.0 * pupil);
    let report = json!({
        "name": lens.name,
        "source": lens.source,
        "efl_mm": paraxial.efl_mm,
        "bfd_mm": paraxial.bfd_mm,
        "surfaces": lens.surfaces.len(),
        "stop": lens.stop + 1,
        "f_number": f_number.is_finite().then_some(f_number).filter(|&number| number > 0.0),
        "film_mm": lens.film_mm,
        "ghosts": single_crossing_ghosts(lens).len(),
        "ghosts_all": ghosts(lens).len(),
    });
    if json {
        say!("{report}");
        return Ok(());
    }
    say!("{}: {}", lens.name, lens.source);
    say!(
        "focal length {:.3} mm, back focus {:.3} mm, {} surfaces, the stop is number {}",
        paraxial.efl_mm,
        paraxial.bfd_mm,
        lens.surfaces.len(),
        lens.stop + 1
    );
    match report["f_number"].as_f64() {
        Some(number) => say!("f/{number:.2} with the stop wide open"),
        None => say!("the file gives no radius of the stop"),
    }
    say!(
        "{} ghosts that cross the stop once, of {} with two reflections",
        report["ghosts"],
        report["ghosts_all"]
    );
    say!("\n  no    radius  thickness       n_d     V_d  semi-diameter");
    for (number, surface) in (1..).zip(&lens.surfaces) {
        let number_or = |value: f64, none: &str| {
            if value.is_finite() && value != 0.0 {
                format!("{value:.3}")
            } else {
                none.to_owned()
            }
        };
        let index = surface.glass.index(D_LINE_UM);
        let mut remarks = Vec::new();
        if number == lens.stop + 1 {
            remarks.push("stop".to_owned());
        }
        remarks.extend(surface.glass.name().map(str::to_owned));
        if surface.conic != 0.0 || !surface.aspheric.is_empty() {
            remarks.push(format!("conic {} {:?}", surface.conic, surface.aspheric));
        }
        let v_d = if index > 1.0 {
            number_or(surface.glass.abbe_number(), "-")
        } else {
            "-".to_owned()
        };
        say!(
            "  {number:2} {:>9} {:>10.3} {:>9.5} {v_d:>7} {:>14}  {}",
            number_or(surface.radius_mm, "plane"),
            surface.thickness_mm,
            index,
            number_or(surface.semi_diameter_mm.unwrap_or(0.0), "-"),
            remarks.join(", ")
        );
    }
    Ok(())
}

fn matrix(m: DMat2) -> Value {
    json!([[m.x_axis.x, m.y_axis.x], [m.x_axis.y, m.y_axis.y]])
}

fn list_ghosts(lens: &Lens, json: bool) -> Result<(), CommandError> {
    let paraxial = Paraxial::new(lens, D_LINE_UM, None);
    let rows: Vec<Value> = ghosts(lens)
        .into_iter()
        .map(|ghost| {
            let matrices = paraxial.matrices(Some(ghost));
            json!({
                "i": ghost.first + 1,
                "j": ghost.second + 1,
                "crossings": crossings(lens, Some(ghost)),
                "ma": matrix(matrices.ma),
                "ms": matrix(matrices.ms),
                "mf": matrix(matrices.mf),
            })
        })
        .collect();
    if json {
        say!("{}", Value::from(rows));
        return Ok(());
    }
    say!("  i  j  crossings      size   shift mm/rad");
    for row in &rows {
        say!(
            "{:3}{:3} {:10} {:9.4} {:14.3}",
            row["i"],
            row["j"],
            row["crossings"],
            row["mf"][0][0].as_f64().unwrap_or_default(),
            row["mf"][0][1].as_f64().unwrap_or_default()
        );
    }
    Ok(())
}

fn trace(
    lens: &Lens,
    ghost: Option<Ghost>,
    angle_deg: f64,
    entry: DVec2,
    wavelength_nm: Option<f64>,
    sensor: Option<&str>,
    json: bool,
) -> Result<(), CommandError> {
    let bad = |what: String| Err(CommandError::Argument(what));
    if !angle_deg.is_finite() || angle_deg.abs() >= 90.0 {
        return bad(format!("--angle {angle_deg}: give degrees between -90 and 90"));
    }
    let wavelength_um = wavelength_nm.map_or(D_LINE_UM, |nm| nm * 1e-3);
    if !(0.2..=3.0).contains(&wavelength_um) {
        return bad("--wavelength: give 200 to 3000 nanometres".to_owned());
    }
    let gap = match sensor {
        None => Paraxial::new(lens, D_LINE_UM, None).sensor_gap_mm(),
        Some("file") => lens.surfaces[lens.surfaces.len() - 1].thickness_mm,
        Some(text) => match text.parse::<f64>() {
            Ok(gap) if gap.is_finite() => gap,
            _ => return bad(format!("--sensor {text}: give millimetres, or `file`")),
        },
    };
    let tracer = Tracer::new(lens, wavelength_um, gap);
    let ray = tracer.trace(ghost, entry, beam_direction(angle_deg.to_radians()));
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
    if json {
        say!("{report}");
        return Ok(());
    }
    match ray {
        None => say!("the ray misses a surface or is reflected totally"),
        Some(ray) => {
            say!("stop   {:.6}, {:.6} mm", ray.stop_mm.x, ray.stop_mm.y);
            say!("sensor {:.6}, {:.6} mm", ray.sensor_mm.x, ray.sensor_mm.y);
            say!(
                "{}; at most {:.3} of a clear radius",
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
