//! `rilievo lens flare`: a picture of the sun's flare in a lens.

use std::path::PathBuf;

use glam::DVec2;

use super::CommandError;
use super::lens_flags::ghost_of;
use crate::camera::Paraxial;
use crate::camera::flare::{Aperture, FlareMode, FlareSource, FlareTable};
use crate::camera::lens::{D_LINE_UM, Lens, open};
use crate::gpu::Gpu;
use crate::output::{auto_exposure, developed, flare_picture, write_png, write_radiance};

/// Flags of `lens flare`.
#[derive(Debug, clap::Args)]
pub struct FlareArgs {
    /// A built-in name or a file.
    lens: String,
    /// The sun: degrees from the axis, and degrees from the right towards the top of the picture.
    #[arg(long, value_parser = super::lens_flags::millimetres, allow_hyphen_values = true)]
    angle: DVec2,
    /// The f-number.
    #[arg(long, value_parser = super::lens_flags::f_number)]
    f_number: f64,
    /// How ghosts are made.
    #[arg(long, value_enum, default_value = "paraxial")]
    mode: FlareMode,
    /// Bake the blended mode's table first and draw from it, instead of tracing for this one angle.
    #[arg(long)]
    table: bool,
    /// Draw this ghost alone: I,J.
    #[arg(long, value_parser = super::lens_flags::pair)]
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

/// Draws and writes.
pub fn run(args: &FlareArgs) -> Result<(), CommandError> {
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
