//! `rilievo lens flare`: a picture of the sun's flare in a lens.

use std::f64::consts::PI;
use std::path::PathBuf;

use glam::DVec2;

use super::CommandError;
use super::flare_flags::FlareFlags;
use super::lens_flags::{aperture, ghost_of};
use crate::camera::flare::{FlareMode, FlareParameters, FlareSource, Pattern, Quality, TableFile, Tracing};
use crate::camera::lens::open;
use crate::camera::single_crossing_ghosts;
use crate::gpu::Gpu;
use crate::output::{FlareRenderer, RenderError, auto_exposure, tone_mapped, write_png, write_radiance};

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
    #[command(flatten)]
    flare: FlareFlags,
    /// Bake the blended mode's table first and draw from it, instead of tracing for this one angle.
    #[arg(long, conflicts_with = "flare_table")]
    table: bool,
    /// Trace rays on the CPU in f64, not on the GPU in f32.
    #[arg(long)]
    cpu: bool,
    /// Draw every ghost alone in a cell of its own.
    #[arg(long, conflicts_with_all = ["ghost", "linear"])]
    sheet: bool,
    /// Draw this ghost alone: I,J.
    #[arg(long, value_parser = super::lens_flags::pair)]
    ghost: Option<[usize; 2]>,
    /// Wavelengths: 3, or more for colour fringes [default: the quality's].
    #[arg(long, value_parser = clap::value_parser!(u32).range(3..=64))]
    wavelengths: Option<u32>,
    /// Rays along a side of a traced ghost's grid [default: the quality's, else 64].
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=512))]
    rays: Option<u32>,
    /// Draw over the whole front of the lens, not the effective pupil alone: the same picture by more work.
    #[arg(long)]
    whole_entrance: bool,
    /// Blades of the iris; fewer than 3 are a circle.
    #[arg(long, default_value_t = 8)]
    blades: u32,
    /// Picture size, pixels.
    #[arg(long, default_value = "960x640", value_parser = super::values::size)]
    size: [u32; 2],
    /// The picture to write. Its exposure is that of the paraxial flare, whatever the mode.
    #[arg(long)]
    out: PathBuf,
    /// Linear radiance for a sun of irradiance 1 (f32 TIFF).
    #[arg(long)]
    linear: Option<PathBuf>,
}

/// Draws and writes.
pub fn run(args: &FlareArgs) -> Result<(), CommandError> {
    super::values::require_folder(&args.out)?;
    let lens = open(&args.lens)?;
    let ghost = args.ghost.map(|pair| ghost_of(&lens, pair)).transpose()?;
    if args.angle.x.abs() >= 90.0 {
        return Err(CommandError::Argument(format!(
            "--angle {}: give degrees between -90 and 90 from the axis",
            args.angle.x
        )));
    }
    let preset = args.flare.preset(Quality::Low);
    let gpu = Gpu::open().map_err(RenderError::from)?;
    let renderer = FlareRenderer::new(&gpu, &aperture(args.blades));
    // A picture of one angle can afford more than a moving one.
    let own_rays = if args.flare.has_quality() { preset.rays } else { 64 };
    let source = FlareSource {
        // A negative angle is a positive one on the other side.
        angle: args.angle.x.abs().to_radians(),
        turn: args.angle.y.to_radians() + if args.angle.x < 0.0 { PI } else { 0.0 },
        irradiance: [1.0; 3],
        f_number: args.f_number,
        wavelengths: args
            .wavelengths
            .map_or(preset.wavelengths, |count| count as usize),
        rays: args.rays.map_or(own_rays, |count| count as usize),
        whole_entrance: args.whole_entrance,
    };
    let table = match args.flare.table(&lens, args.f_number)? {
        None if args.table && preset.mode == FlareMode::Blended => Some(TableFile::Rays(
            super::lens_bake::bake_rays(&lens, args.f_number)?,
        )),
        table => table,
    };
    let nothing = (None, None, Pattern::Whole);
    let (rays, images, pattern) = table.as_ref().map_or(nothing, |table| table.at(source.angle));
    let parameters = FlareParameters {
        lens: &lens,
        source,
        mode: preset.mode,
        only: ghost,
        pattern,
        table: rays,
        blend: args.flare.blend,
        fit: args.flare.fit(),
        tracing: if args.cpu {
            Tracing::Cpu
        } else {
            renderer.tracing()
        },
    };
    if args.sheet {
        let parameters = FlareParameters {
            pattern: Pattern::Whole,
            ..parameters
        };
        let (pixels, columns) = renderer.sheet(&parameters, args.size)?;
        write_png(&args.out, args.size, &pixels)?;
        for (row, ghosts) in single_crossing_ghosts(&lens).chunks(columns).enumerate() {
            let names: Vec<String> = ghosts
                .iter()
                .map(|ghost| format!("{},{}", ghost.first + 1, ghost.second + 1))
                .collect();
            say!("row {}: {}", row + 1, names.join("  "));
        }
        return Ok(());
    }
    let paraxial = FlareParameters {
        mode: FlareMode::Paraxial,
        pattern: Pattern::Whole,
        ..parameters
    };
    let exposure = auto_exposure(&renderer.picture(&paraxial, None, args.size)?.radiance);
    let picture = renderer.picture(&parameters, images, args.size)?;
    write_png(&args.out, args.size, &tone_mapped(&picture.radiance, exposure))?;
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
