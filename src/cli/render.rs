//! `rilievo render`: one view of a city to a PNG, with depth and ids where asked.

use std::path::PathBuf;

use glam::DVec3;

use super::CommandError;
use super::camera_flags::{CameraFlags, sun};
use super::pool_flags::{PoolFlags, tell_warnings};
use super::relief_flags::ReliefFlags;
use super::values::{is_same_file, require_other, require_place};
use crate::city::City;
use crate::gpu::Gpu;
use crate::output::{
    FlightView, FrameRequest, ImageKind, Intermediate, MAX_WINDOW_PX, RenderError, Renderer, image_kind,
    write_depth, write_ids, write_png, write_radiance,
};
use crate::relief::ReliefMode;
use crate::scene::{PoolOptions, TerrainMesh};

/// Flags of `render`.
#[derive(Debug, clap::Args)]
pub struct RenderArgs {
    /// The city folder.
    city: PathBuf,
    /// Eye: easting, northing, height in the city's CRS, metres.
    #[arg(long, value_parser = super::values::point, allow_hyphen_values = true, required_unless_present = "path", requires = "look")]
    eye: Option<DVec3>,
    /// A point to look at: easting, northing, height.
    #[arg(long, value_parser = super::values::point, allow_hyphen_values = true, requires = "eye")]
    look: Option<DVec3>,
    /// Instead: the view of a flight path (`rilievo film`).
    #[arg(long, conflicts_with_all = ["eye", "look"])]
    path: Option<PathBuf>,
    /// Seconds on that flight path [default: its first view].
    #[arg(long, requires = "path")]
    at: Option<f64>,
    #[command(flatten)]
    camera: CameraFlags,
    #[command(flatten)]
    pool: PoolFlags,
    /// Image size, pixels, up to 65535 a side: drawn in parts where it is too large for the device.
    #[arg(long, default_value = "1280x720", value_parser = super::values::image_size)]
    size: [u32; 2],
    /// Date and time for the sun, like 2026-06-21T19:40:00+02:00 [default: a sun in the south-west, 42 degrees high].
    #[arg(long)]
    time: Option<String>,
    #[command(flatten)]
    relief: ReliefFlags,
    /// Draw every terrain sample instead of the TIN.
    #[arg(long)]
    terrain_grid: bool,
    /// Samples a pixel: anti-aliasing, soft shadows and sky light.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=4096))]
    samples: u32,
    /// Factor on the light before tone mapping.
    #[arg(long, default_value_t = 1.0, value_parser = super::values::exposure)]
    exposure: f32,
    /// Write an intermediate image of the last sample in false colours, instead of the image.
    #[arg(long, value_enum)]
    intermediate: Option<Intermediate>,
    /// The image to write: PNG, or where it ends in .tif linear radiance (f32, RGB), before exposure and tone mapping.
    #[arg(long)]
    out: PathBuf,
    /// Metres along the view ray, NaN = sky (f32 TIFF).
    #[arg(long)]
    depth: Option<PathBuf>,
    /// Building ids, 0 = ground or sky (u32 TIFF).
    #[arg(long)]
    ids: Option<PathBuf>,
}

/// What to draw: a view of its own, or that of a flight.
fn view(args: &RenderArgs, city: &City) -> Result<FlightView, CommandError> {
    match (&args.path, args.eye, args.look) {
        (Some(path), ..) => super::film::view_at(path, args.at, city),
        (None, Some(eye), Some(target)) => Ok(FlightView {
            eye,
            target,
            ..FlightView::default()
        }),
        _ => Err(CommandError::Argument(
            "give --eye and --look, or --path".to_owned(),
        )),
    }
}

/// Draws and writes.
pub fn run(args: &RenderArgs) -> Result<(), CommandError> {
    let written: Vec<&PathBuf> = [Some(&args.out), args.depth.as_ref(), args.ids.as_ref()]
        .into_iter()
        .flatten()
        .collect();
    for (index, path) in written.iter().enumerate() {
        require_place(path)?;
        require_other(path, &args.path.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
        if written[..index].iter().any(|other| is_same_file(other, path)) {
            return Err(CommandError::Argument(format!(
                "{}: is named for two pictures; give each its own file",
                path.display()
            )));
        }
    }
    let kind = image_kind(&args.out)?;
    if args.intermediate.is_some() && kind != ImageKind::Display {
        return Err(CommandError::Argument(
            "--intermediate draws false colours; name a file that ends in .png".to_owned(),
        ));
    }
    if args.intermediate.is_some() && args.size.iter().any(|&side| side > MAX_WINDOW_PX) {
        return Err(CommandError::Argument(format!(
            "--intermediate draws what is drawn at once; give a size of at most {MAX_WINDOW_PX} pixels a side"
        )));
    }
    let city = City::open(&args.city)?;
    let place = city.manifest().place;
    let view = view(args, &city)?;
    let camera = view.camera(&args.camera.camera(view.pose(), args.size)?.optics);
    let flare = args.camera.flare(&camera)?;
    let mesh = if args.terrain_grid {
        TerrainMesh::Grid
    } else {
        TerrainMesh::Tin
    };
    let options = PoolOptions {
        // Only the sun's way into a lens is cast on the CPU.
        casts_rays: flare.is_some(),
        ..args.pool.options(mesh)
    };
    // The sky's tables are made while the device is opened.
    let (gpu, sun) = std::thread::scope(|scope| {
        let opening = scope.spawn(Gpu::open);
        let sun = sun(args.time.as_deref(), place).and_then(|sun| Ok(view.sun_or(sun, place)?));
        (opening.join(), sun)
    });
    let sun = sun?;
    let gpu = gpu.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    let request = FrameRequest {
        camera: &camera,
        sun: &sun,
        size: args.size,
        relief: args.relief.settings(),
        flare: flare.as_ref(),
        exposure: view.exposure_or(args.exposure),
    };
    let mut renderer = Renderer::open_for(gpu.map_err(RenderError::from)?, &city, options, &request)?;
    if args.relief.relief == ReliefMode::Polygons {
        renderer.load_polygons(&city)?;
    }
    let with_radiance = kind != ImageKind::Display;
    let still = renderer.still_of(&vec![request; args.samples as usize], with_radiance)?;
    tell_warnings(&mut renderer);
    let eye = camera.pose.eye;
    // A damaged tile has been told.
    let ground = city.ground().at(eye.x, eye.y).ok().flatten();
    if let Some(ground) = ground.filter(|ground| *ground > eye.z) {
        eprintln!(
            "rilievo: the eye lies {:.1} m below the ground, which is at {ground:.1} there",
            ground - eye.z
        );
    }
    match (args.intermediate, kind) {
        (Some(which), _) => write_png(&args.out, args.size, &renderer.debug_image(which)?)?,
        (None, ImageKind::Display) => write_png(&args.out, args.size, &still.rgba)?,
        (None, ImageKind::RadianceTiff | ImageKind::RadianceExr) => {
            write_radiance(&args.out, args.size, &still.radiance)?
        }
    }
    if let Some(path) = &args.depth {
        write_depth(path, args.size, &still.depth)?;
    }
    if let Some(path) = &args.ids {
        write_ids(path, args.size, &still.ids)?;
    }
    Ok(())
}
