//! `rilievo fly`: the window.

use std::path::PathBuf;

use glam::DVec3;

use super::CommandError;
use super::camera_flags::CameraFlags;
use super::path_file::read_path;
use super::pool_flags::PoolFlags;
use crate::city::City;
use crate::scene::{PoolOptions, TerrainMesh};
use crate::space::Pose;
use crate::viewer::{Clock, ViewerOptions, run as run_viewer};

/// Flags of `fly`.
#[derive(Debug, clap::Args)]
pub struct FlyArgs {
    /// The city folder, or survey files to import [default: a choice of cities].
    city: Vec<PathBuf>,
    /// Eye: easting, northing, height in the city's CRS, metres [default: where it was left, or a view of the whole city].
    #[arg(long, value_parser = super::values::point, allow_hyphen_values = true, requires_all = ["look", "city"])]
    eye: Option<DVec3>,
    /// A point to look at: easting, northing, height.
    #[arg(long, value_parser = super::values::point, allow_hyphen_values = true, requires = "eye")]
    look: Option<DVec3>,
    #[command(flatten)]
    camera: CameraFlags,
    #[command(flatten)]
    pool: PoolFlags,
    /// Window size, pixels.
    #[arg(long, default_value = "1280x720", value_parser = super::values::size)]
    size: [u32; 2],
    /// Date and time for the sun, like 2026-06-21T19:40:00+02:00 [default: four in the afternoon of midsummer].
    #[arg(long)]
    time: Option<String>,
    /// A flight to play (`rilievo film`).
    #[arg(long, requires = "city")]
    path: Option<PathBuf>,
    /// Folder for the images and flights that are saved.
    #[arg(long, default_value = ".")]
    images: PathBuf,
    /// Write a line of JSON for every frame: pose, size, samples, milliseconds.
    #[arg(long)]
    journal: Option<PathBuf>,
}

/// Opens the window; returns when it is closed.
pub fn run(args: &FlyArgs) -> Result<(), CommandError> {
    if let Some(path) = &args.journal {
        super::values::require_place(path)?;
    }
    let files: Vec<PathBuf> = args.city.iter().filter(|path| path.is_file()).cloned().collect();
    let city = match args.city.as_slice() {
        [] => None,
        paths if files.len() == paths.len() => None,
        [folder] => Some(City::open(folder)?),
        _ => {
            let text = "give the folder of one city, or survey files alone";
            return Err(CommandError::Argument(text.to_owned()));
        }
    };
    let path = match (&args.path, &city) {
        (Some(path), Some(city)) => Some(read_path(path, city)?),
        _ => None,
    };
    let pose = args
        .eye
        .zip(args.look)
        .map(|(eye, target)| Pose::looking_at(eye, target));
    // The optics do not depend on where the camera is.
    let anywhere = Pose::looking_along(DVec3::ZERO, DVec3::Y);
    let camera = args.camera.camera(pose.unwrap_or(anywhere), args.size)?;
    let place = city.as_ref().map(|city| city.manifest().place);
    let clock = match (&args.time, place) {
        (Some(text), Some(place)) => {
            let wrong = |error: jiff::Error| CommandError::Argument(format!("--time {text}: {error}"));
            let instant: jiff::Timestamp = text.parse().map_err(wrong)?;
            let offset = jiff::fmt::temporal::Pieces::parse(text)
                .map_err(wrong)?
                .to_numeric_offset();
            Some(Clock::new(place, instant, offset))
        }
        _ => None,
    };
    Ok(run_viewer(ViewerOptions {
        flare: args.camera.flare(&camera)?,
        optics: camera.optics,
        city,
        files,
        pool: PoolOptions {
            streams: true,
            ..args.pool.options(TerrainMesh::Tin)
        },
        pose,
        path,
        clock,
        size: args.size,
        image_folder: args.images.clone(),
        journal: args.journal.clone(),
    })?)
}
