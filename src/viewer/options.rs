//! What the window is asked.

use std::path::PathBuf;

use super::Clock;
use crate::camera::Optics;
use crate::city::City;
use crate::output::{FlareSettings, FlightPath};
use crate::scene::PoolOptions;
use crate::space::Pose;

/// What the window begins with.
pub struct ViewerOptions {
    /// The city; without one the window begins with a choice of them.
    pub city: Option<City>,
    /// Survey files to import, where there is no city yet.
    pub files: Vec<PathBuf>,
    /// How much of it is held on the device.
    pub pool: PoolOptions,
    /// The first view; without one, that which the city was left with, or one of the whole city.
    pub pose: Option<Pose>,
    /// What makes the image.
    pub optics: Optics,
    /// What the lens adds.
    pub flare: Option<FlareSettings>,
    /// Date and time; without them an afternoon of midsummer.
    pub clock: Option<Clock>,
    /// A flight to play.
    pub path: Option<FlightPath>,
    /// Pixels of the window.
    pub size: [u32; 2],
    /// Where images and flights are saved.
    pub image_folder: PathBuf,
    /// A journal of the frames.
    pub journal: Option<PathBuf>,
}
