//! `rilievo lens`: prescriptions, their first-order data, ghosts, rays and drawings.

use std::path::PathBuf;

use glam::DMat2;
use serde_json::{Value, json};

use super::CommandError;
use super::lens_flags::ghost_of;
use crate::camera::lens::{BUILT_IN, D_LINE_UM, Lens, built_in, open, to_toml};
use crate::camera::{Paraxial, crossings, ghosts, lens_diagram, single_crossing_ghosts};
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
    /// An image of the flare of the sun.
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
    Trace(super::lens_trace::TraceArgs),
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
            super::values::require_place(&out)?;
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
        LensCommand::Trace(args) => super::lens_trace::run(&args),
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
    let report = json!({
        "name": lens.name,
        "source": lens.source,
        "efl_mm": paraxial.efl_mm,
        "bfd_mm": paraxial.bfd_mm,
        "surfaces": lens.surfaces.len(),
        "stop": lens.stop + 1,
        "f_number": paraxial.widest_f_number(lens),
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
