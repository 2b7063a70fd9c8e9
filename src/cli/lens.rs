//! `rilievo lens`: prescriptions, their first-order data, ghosts, rays and drawings.

use std::path::PathBuf;

use glam::{DMat2, DVec2};
use serde_json::{Value, json};

use super::CommandError;
use crate::camera::flare::{Aperture, FlareMode, FlareSource, FlareTable};
use crate::camera::lens::{BUILT_IN, D_LINE_UM, Lens, built_in, open, to_toml};
use crate::camera::{
    Ghost, Paraxial, Tracer, beam_direction, crossings, ghosts, lens_diagram, single_crossing_ghosts,
};
use crate::gpu::Gpu;
use crate::output::{auto_exposure, developed, flare_picture, write_drawing, write_png, write_radiance};

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
        #[arg(long, value_parser = pair)]
        ghost: Option<[usize; 2]>,
        /// The drawing to write, .svg or .png.
        #[arg(long)]
        out: PathBuf,
    },
    /// A picture of the flare of the sun.
    Flare(FlareArgs),
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
        #[arg(long, value_parser = pair)]
        ghost: Option<[usize; 2]>,
        /// Angle of the beam from the axis, degrees: its direction is (sin, 0, cos).
        #[arg(long, allow_hyphen_values = true)]
        angle: f64,
        /// Where the ray crosses the plane of the first vertex: X,Y in millimetres.
        #[arg(long, value_parser = millimetres, allow_hyphen_values = true)]
        entry: DVec2,
        /// Wavelength, nanometres [default: the d line].
        #[arg(long)]
        wavelength: Option<f64>,
        /// Sensor behind the last vertex, millimetres, or `file` for the file's own gap [default: the paraxial focus].
        #[arg(long)]
        sensor: Option<String>,
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
}

/// Flags of `lens flare`.
#[derive(Debug, clap::Args)]
pub struct FlareArgs {
    /// A built-in name or a file.
    lens: String,
    /// The sun: degrees from the axis, and degrees from the right towards the top of the picture.
    #[arg(long, value_parser = millimetres, allow_hyphen_values = true)]
    angle: DVec2,
    /// The f-number.
    #[arg(long, value_parser = f_number)]
    f_number: f64,
    /// How ghosts are made.
    #[arg(long, value_enum, default_value = "paraxial")]
    mode: FlareMode,
    /// Bake the blended mode's table first and draw from it, instead of tracing for this one angle.
    #[arg(long)]
    table: bool,
    /// Draw this ghost alone: I,J.
    #[arg(long, value_parser = pair)]
    ghost: Option<[usize; 2]>,
    /// Wavelengths: 3, or more for colour fringes.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(3..=64))]
    wavelengths: u32,
    /// Rays along a side of a traced ghost's grid.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(2..=1024))]
    rays: u32,
    /// Draw over the whole front of the lens, not the effective pupil alone: the same picture by more work.
    #[arg(long)]
    whole_entrance: bool,
    /// Blades of the iris; fewer than 3 are a circle.
    #[arg(long, default_value_t = 8)]
    blades: u32,
    /// Picture size, pixels.
    #[arg(long, default_value = "960x640", value_parser = super::render::size)]
    size: [u32; 2],
    /// The picture to write. Its exposure is that of the paraxial flare, whatever the mode.
    #[arg(long)]
    out: PathBuf,
    /// Linear radiance for a sun of irradiance 1 (f32 TIFF).
    #[arg(long)]
    linear: Option<PathBuf>,
}

/// An f-number.
pub fn f_number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (0.5..=256.0).contains(&number) => Ok(number),
        _ => Err("give an f-number between 0.5 and 256".to_owned()),
    }
}

fn pair(text: &str) -> Result<[usize; 2], String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[first, second]) if first > second && second > 0 => Ok([first, second]),
        _ => Err("give two surface numbers I,J with I > J, such as 9,7".to_owned()),
    }
}

fn millimetres(text: &str) -> Result<DVec2, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y]) if x.is_finite() && y.is_finite() => Ok(DVec2::new(x, y)),
        _ => Err("give two numbers X,Y".to_owned()),
    }
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
        LensCommand::Flare(args) => flare(&args),
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

/// A ghost from surface numbers counted from 1.
fn ghost_of(lens: &Lens, [first, second]: [usize; 2]) -> Result<Ghost, CommandError> {
    if first > lens.surfaces.len() {
        return Err(CommandError::Argument(format!(
            "{}: there is no surface {first}; it has {}, the stop counted",
            lens.name,
            lens.surfaces.len()
        )));
    }
    Ok(Ghost {
        first: first - 1,
        second: second - 1,
    })
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

/// Bakes a lens's table to beyond the corner of its film, and says how large it is.
fn bake(lens: &Lens, f_number: f64) -> FlareTable {
    let start = std::time::Instant::now();
    let table = FlareTable::bake(lens, f_number, most_angle(lens));
    say!(
        "table: {} ghosts, {:.2} MB, {:.0} ms to bake",
        table.len(),
        table.bytes() as f64 * 1e-6,
        start.elapsed().as_secs_f64() * 1e3
    );
    table
}

/// Angle of the film's corner and a third more, radians.
pub fn most_angle(lens: &Lens) -> f64 {
    let half_diagonal = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
    let corner = half_diagonal.atan2(Paraxial::new(lens, D_LINE_UM, None).efl_mm.abs());
    (1.35 * corner).clamp(0.37, 1.2)
}

fn flare(args: &FlareArgs) -> Result<(), CommandError> {
    let lens = open(&args.lens)?;
    let ghost = args.ghost.map(|pair| ghost_of(&lens, pair)).transpose()?;
    if args.angle.x.abs() >= 90.0 {
        return Err(CommandError::Argument(format!(
            "--angle {}: give degrees between -90 and 90 from the axis",
            args.angle.x
        )));
    }
    let gpu = Gpu::open().map_err(crate::output::RenderError::from)?;
    let source = FlareSource {
        angle: args.angle.x.to_radians(),
        turn: args.angle.y.to_radians(),
        irradiance: [1.0; 3],
        f_number: args.f_number,
        wavelengths: args.wavelengths as usize,
        rays: args.rays as usize,
        whole_entrance: args.whole_entrance,
    };
    let aperture = Aperture {
        blades: args.blades,
        ..Aperture::default()
    };
    let table = (args.table && args.mode == FlareMode::Blended).then(|| bake(&lens, args.f_number));
    let draw = |mode| {
        flare_picture(
            &gpu,
            &lens,
            &source,
            mode,
            ghost,
            table.as_ref(),
            &aperture,
            args.size,
        )
    };
    let linear = draw(FlareMode::Paraxial)?;
    let exposure = auto_exposure(&linear.radiance);
    let picture = match args.mode {
        FlareMode::Paraxial => linear,
        mode => draw(mode)?,
    };
    write_png(&args.out, args.size, &developed(&picture.radiance, exposure))?;
    if let Some(path) = &args.linear {
        write_radiance(path, args.size, &picture.radiance)?;
    }
    say!(
        "{} triangles over {:.0} square millimetres of film, {:.1} ms to make, {} ms to draw",
        picture.triangles,
        picture.area_mm2,
        picture.mesh_ms,
        picture.gpu_ms.map_or("-".to_owned(), |ms| format!("{ms:.2}"))
    );
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
