//! `rilievo lens flare`: an image of the sun's flare in a lens.

use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec2;

use super::CommandError;
use super::flare_flags::FlareFlags;
use super::lens_flags::{aperture, ghost_of};
use crate::camera::flare::{
    FlareImager, FlareLight, FlareMode, FlareRequest, GhostParameters, GhostTable, Quality,
    StarburstParameters, TracingDevice, film_half_mm,
};
use crate::camera::lens::open;
use crate::camera::{auto_exposure, require_f_number, single_crossing_ghosts, tone_mapped};
use crate::gpu::Gpu;
use crate::output::{RenderError, contact_sheet, write_png, write_radiance};
use crate::space::SOLAR_ANGULAR_RADIUS;

/// Flags of `lens flare`.
#[derive(Debug, clap::Args)]
pub struct FlareArgs {
    /// A built-in name or a file.
    lens: String,
    /// The sun: degrees from the axis, and degrees from the right towards the top of the image.
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
    /// Leave out the sun's own image and its starburst.
    #[arg(long)]
    ghosts_only: bool,
    /// A point of light instead of the sun's disc: ghosts with sharp edges.
    #[arg(long)]
    point: bool,
    /// Draw this ghost alone: I,J.
    #[arg(long, value_parser = super::lens_flags::pair)]
    ghost: Option<[usize; 2]>,
    /// Wavelengths: 3, or more for colour fringes [default: the quality's].
    #[arg(long, value_parser = clap::value_parser!(u32).range(3..=64))]
    wavelengths: Option<u32>,
    /// Rays along a side of a traced ghost's grid [default: the quality's, else 64].
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=512))]
    rays: Option<u32>,
    /// Draw over the whole front of the lens, not the effective pupil alone: the same image by more work.
    #[arg(long)]
    whole_entrance: bool,
    /// Blades of the iris; fewer than 3 are a circle.
    #[arg(long, default_value_t = 8)]
    blades: u32,
    /// Image size, pixels.
    #[arg(long, default_value = "960x640", value_parser = super::values::size)]
    size: [u32; 2],
    /// The image to write. Its exposure is that of the paraxial flare, whatever the mode; less where the sun's glare would fill it.
    #[arg(long)]
    out: PathBuf,
    /// Linear radiance for a sun of irradiance 1 (f32 TIFF).
    #[arg(long)]
    linear: Option<PathBuf>,
}

/// What half of an image with the sun in it stays below, of the display's white.
const MIDDLE: f32 = 0.22;

/// Median of the pixels' brightest channels.
fn median_of(radiance: &[[f32; 3]]) -> f32 {
    let mut brightest: Vec<f32> = radiance
        .iter()
        .map(|rgb| rgb.iter().copied().fold(0.0, f32::max))
        .collect();
    let middle = brightest.len() / 2;
    *brightest.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// Most rays of a flare: a gigabyte of triangles.
const MAX_RAYS: u64 = 24_000_000;

/// Draws and writes.
pub fn run(args: &FlareArgs) -> Result<(), CommandError> {
    super::values::require_place(&args.out)?;
    let lens = Arc::new(open(&args.lens)?);
    require_f_number(&lens, args.f_number)?;
    let ghost = args.ghost.map(|pair| ghost_of(&lens, pair)).transpose()?;
    if args.angle.x.abs() >= 90.0 {
        return Err(CommandError::Argument(format!(
            "--angle {}: give degrees between -90 and 90 from the axis",
            args.angle.x
        )));
    }
    let preset = args.flare.preset(Quality::Low);
    let gpu = Gpu::open().map_err(RenderError::from)?;
    // An image of one angle can afford more than a moving one.
    let own_rays = if args.flare.has_quality() { preset.rays } else { 64 };
    let table = match args.flare.table(&lens, args.f_number, aperture(args.blades))? {
        None if args.table && preset.mode == FlareMode::Blended => Some(GhostTable::of_rays(
            super::lens_bake::bake_rays(&lens, args.f_number)?,
        )),
        table => table,
    };
    let ghosts = GhostParameters {
        wavelengths: args
            .wavelengths
            .map_or(preset.wavelengths, |count| count as usize),
        rays: args.rays.map_or(own_rays, |count| count as usize),
        only: ghost,
        blend: args.flare.blend,
        fit: args.flare.fit(),
        photographed: args.flare.photographed,
        whole_entrance: args.whole_entrance,
        tracing: if args.cpu {
            TracingDevice::Cpu
        } else {
            TracingDevice::Gpu
        },
        ..preset.ghosts()
    };
    let ghost_count = ghost.map_or_else(|| single_crossing_ghosts(&lens).len(), |_| 1);
    let traced = ghost_count as u64 * ghosts.wavelengths as u64 * (ghosts.rays as u64).pow(2);
    if traced > MAX_RAYS && ghosts.mode != FlareMode::Paraxial && ghosts.mode != FlareMode::TwoRays {
        return Err(CommandError::Argument(format!(
            "--rays {} with --wavelengths {}: {} million rays of {ghost_count} ghosts, more than {}; lower one of them",
            ghosts.rays,
            ghosts.wavelengths,
            traced / 1_000_000,
            MAX_RAYS / 1_000_000
        )));
    }
    let shows_sun = !(args.ghosts_only || args.sheet || ghost.is_some());
    let request = FlareRequest {
        f_number: args.f_number,
        aperture: aperture(args.blades),
        ghosts: Some(ghosts),
        starburst: shows_sun.then(|| StarburstParameters {
            with_disc: true,
            ..preset.starburst()
        }),
        table: table.map(Arc::new),
        light: FlareLight {
            angular_radius: if args.point { 0.0 } else { SOLAR_ANGULAR_RADIUS },
            // A negative angle is a positive one on the other side.
            ..FlareLight::point(
                args.angle.x.abs().to_radians(),
                args.angle.y.to_radians() + if args.angle.x < 0.0 { PI } else { 0.0 },
            )
        },
        image_half_mm: film_half_mm(&lens, args.size),
        lens,
    };
    let mut imager = FlareImager::new(&gpu);
    if args.sheet {
        let sheet = contact_sheet(&mut imager, &request, args.size).map_err(RenderError::from)?;
        write_png(&args.out, args.size, &sheet.rgba)?;
        for (row, ghosts) in single_crossing_ghosts(&request.lens)
            .chunks(sheet.columns)
            .enumerate()
        {
            let names: Vec<String> = ghosts
                .iter()
                .map(|ghost| format!("{},{}", ghost.first + 1, ghost.second + 1))
                .collect();
            say!("row {}: {}", row + 1, names.join("  "));
        }
        return Ok(());
    }
    let paraxial = FlareRequest {
        ghosts: Some(GhostParameters {
            mode: FlareMode::Paraxial,
            ..ghosts
        }),
        table: None,
        starburst: None,
        ..request.clone()
    };
    let mut draw = |request| imager.draw(request, args.size).map_err(RenderError::from);
    let exposure = auto_exposure(&draw(&paraxial)?.radiance);
    let image = draw(&request)?;
    // With the sun in it, no brighter than leaves half of the image below a middle grey.
    let exposure = match shows_sun {
        true => exposure.min(MIDDLE / median_of(&image.radiance).max(f32::MIN_POSITIVE)),
        false => exposure,
    };
    write_png(&args.out, args.size, &tone_mapped(&image.radiance, exposure))?;
    if let Some(path) = &args.linear {
        write_radiance(path, args.size, &image.radiance)?;
    }
    say!(
        "{} triangles over {:.0} square millimetres of film, {:.1} ms to make, {} ms to draw",
        image.mesh.triangles,
        image.mesh.area_mm2,
        image.mesh.make_ms,
        image.gpu_ms.map_or("-".to_owned(), |ms| format!("{ms:.2}"))
    );
    Ok(())
}
