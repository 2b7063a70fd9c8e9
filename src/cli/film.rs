//! `rilievo film`: a flight to a video or to numbered frames.

use std::path::{Path, PathBuf};

use glam::DVec3;
use indicatif::{ProgressBar, ProgressStyle};

use super::CommandError;
use super::camera_flags::{CameraFlags, sun};
use super::path_file::read_path;
use super::pool_flags::{PoolFlags, tell_warnings};
use super::relief_flags::ReliefFlags;
use super::values::{require_other, require_place};
use crate::camera::require_f_number;
use crate::city::City;
use crate::gpu::Gpu;
use crate::output::{
    FilmFrame, Flight, FlightPath, FlightView, FrameFolder, FrameKind, FramePixels, RenderError, Renderer,
    encode_video, require_encoder,
};
use crate::relief::ReliefMode;
use crate::scene::{PoolOptions, TerrainMesh};
use crate::space::{Pose, Sun};

/// Flags of `film`.
#[derive(Debug, clap::Args)]
pub struct FilmArgs {
    /// The city folder.
    city: PathBuf,
    /// The flight: a JSON list of views {"t": seconds, "eye": [E,N,H], "look": [E,N,H], "fov": degrees, "time": RFC 3339, "f_number",
    /// "exposure"}, of which all but eye and look may be left out; or a track (.gpx, .kml).
    #[arg(long)]
    path: PathBuf,
    /// Frames a second.
    #[arg(long, default_value_t = 30.0, value_parser = frames_per_s)]
    fps: f64,
    /// The film: a file that ends in .mp4, or a folder for numbered files.
    #[arg(long)]
    out: PathBuf,
    /// What the files of a folder hold: PNG, or linear radiance as OpenEXR.
    #[arg(long, value_enum, default_value = "png")]
    frames: FrameKind,
    /// Image size, pixels, up to 65535 a side: drawn in parts where it is too large for the device.
    #[arg(long, default_value = "1280x720", value_parser = super::values::image_size)]
    size: [u32; 2],
    /// Samples a pixel: anti-aliasing, soft shadows, motion blur.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=4096))]
    samples: u32,
    /// The part of a frame's time that the shutter is open, 0 to 1: motion blur.
    #[arg(long, default_value_t = 0.0, value_parser = super::values::fraction)]
    shutter: f64,
    /// Date and time for the sun where the flight names none [default: a sun in the south-west, 42 degrees high].
    #[arg(long)]
    time: Option<String>,
    /// Factor on the light before tone mapping, where the flight names none.
    #[arg(long, default_value_t = 1.0, value_parser = super::values::exposure)]
    exposure: f32,
    #[command(flatten)]
    relief: ReliefFlags,
    #[command(flatten)]
    camera: CameraFlags,
    #[command(flatten)]
    pool: PoolFlags,
}

fn frames_per_s(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if (0.01..=1000.0).contains(&rate) => Ok(rate),
        _ => Err("give frames a second, 0.01 to 1000".to_owned()),
    }
}

/// Most frames of a film: a day at 60 a second.
const MAX_FRAMES: f64 = 86_400.0 * 60.0;

/// Draws every frame that is not there yet, then encodes them.
pub fn run(args: &FilmArgs) -> Result<(), CommandError> {
    require_place(&args.out)?;
    require_other(&args.out, &[&args.path])?;
    let is_video = args
        .out
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("mp4"));
    if is_video {
        require_encoder(&args.out)?;
        if args.frames != FrameKind::Png {
            return Err(CommandError::Argument(format!(
                "{}: a video holds no radiance; name a folder with --frames exr",
                args.out.display()
            )));
        }
    }
    let city = City::open(&args.city)?;
    let path = read_path(&args.path, &city)?;
    let no_views = || CommandError::Argument(format!("{}: has no views", args.path.display()));
    let flight = Flight::new(&path).ok_or_else(no_views)?;
    let [first, last] = flight.span();
    if (last - first) * args.fps > MAX_FRAMES {
        return Err(CommandError::Argument(format!(
            "{}: {} frames; lower --fps, or split the flight",
            args.path.display(),
            (last - first) * args.fps
        )));
    }
    let sun = sun(args.time.as_deref(), city.manifest().place)?;
    let anywhere = Pose::looking_along(DVec3::ZERO, DVec3::Y);
    let camera = args.camera.camera(anywhere, args.size)?;
    if let Some(optics) = camera.lens() {
        for f_number in path.keys.iter().filter_map(|key| key.f_number) {
            require_f_number(&optics.lens, f_number)?;
        }
    }
    let flare = args.camera.flare(&camera)?;
    let film = FilmFrame {
        flight: &flight,
        frames_per_s: args.fps,
        size: args.size,
        samples: args.samples,
        shutter: args.shutter,
        with_radiance: args.frames == FrameKind::Exr,
        relief: args.relief.settings(),
        optics: &camera.optics,
        flare: flare.as_ref(),
        exposure: args.exposure,
    };
    let folder = if is_video {
        args.out.with_extension("frames")
    } else {
        args.out.clone()
    };
    let frames = FrameFolder::open(&folder, &film_key(args, &city, &path), args.frames)?;
    draw_frames(&film, &frames, (args, &city), sun)?;
    if is_video {
        encode_video(&frames, args.fps, &args.out)?;
        frames.remove()?;
    }
    Ok(())
}

/// What tells this film from others: everything that its frames depend on.
fn film_key(args: &FilmArgs, city: &City, path: &FlightPath) -> String {
    let manifest = city.manifest();
    let stamp = |path: PathBuf| {
        let data = std::fs::metadata(&path).ok();
        let time = data.as_ref().and_then(|data| data.modified().ok());
        (path, data.map(|data| data.len()), time)
    };
    let files: Vec<_> = args.camera.files().into_iter().map(stamp).collect();
    format!(
        "{:?}\ngeneration {}\n{:?}\n{:?}\n{files:?}\n",
        (
            args.fps,
            args.size,
            args.samples,
            args.shutter,
            &args.time,
            args.exposure,
            args.frames
        ),
        manifest.generation,
        (manifest, &args.relief, &args.camera, &args.pool),
        path.keys,
    )
}

fn draw_frames(
    film: &FilmFrame<'_>,
    frames: &FrameFolder,
    (args, city): (&FilmArgs, &City),
    sun: Sun,
) -> Result<(), CommandError> {
    let count = film.flight.frame_count(args.fps);
    let missing: Vec<u32> = (0..count).filter(|&frame| !frames.has(frame)).collect();
    let bar = frame_progress(u64::from(count));
    bar.set_position(u64::from(count) - missing.len() as u64);
    bar.reset_eta();
    if missing.is_empty() {
        return Ok(());
    }
    let gpu = Gpu::open().map_err(RenderError::from)?;
    let options = PoolOptions {
        casts_rays: film.flare.is_some(),
        ..args.pool.options(TerrainMesh::Tin)
    };
    let mut renderer = Renderer::open(gpu, city, options)?;
    if film.relief.mode == ReliefMode::Polygons {
        renderer.load_polygons(city)?;
    }
    for frame in missing {
        let sun = film.view(frame).sun_or(sun, city.manifest().place)?;
        let still = film.draw(&mut renderer, frame, &sun)?;
        match args.frames {
            FrameKind::Png => frames.put(frame, film.size, FramePixels::Display(&still.rgba))?,
            FrameKind::Exr => frames.put(frame, film.size, FramePixels::Radiance(&still.radiance))?,
        }
        bar.inc(1);
        tell_warnings(&mut renderer);
    }
    bar.finish();
    Ok(())
}

/// A bar on standard error, when that is a terminal, with the time left.
fn frame_progress(count: u64) -> ProgressBar {
    let bar = ProgressBar::new(count);
    if let Ok(style) = ProgressStyle::with_template("frames {wide_bar} {pos}/{len}  {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// The view of a flight at a time, for a still of it.
///
/// # Errors
/// When the path file cannot be used.
pub fn view_at(path: &Path, time_s: Option<f64>, city: &City) -> Result<FlightView, CommandError> {
    let no_views = || CommandError::Argument(format!("{}: has no views", path.display()));
    let flight = Flight::new(&read_path(path, city)?).ok_or_else(no_views)?;
    Ok(flight.at(time_s.unwrap_or(flight.span()[0])))
}
