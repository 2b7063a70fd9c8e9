//! The commands and their flags.

use clap::{Parser, Subcommand};

/// Survey data in, a true city out.
#[derive(Debug, Parser)]
#[command(name = "rilievo", version, about)]
pub struct Args {
    /// Say more on standard error, GDAL's own messages included.
    #[arg(long, global = true)]
    pub verbose: bool,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write the sample city's source files.
    Sample(super::sample::SampleArgs),
    /// Make a city folder from survey files.
    Import(super::import::ImportArgs),
    /// Change buildings of a city: the building map only.
    Update(super::update::UpdateArgs),
    /// Say what a city holds.
    Info(super::info::InfoArgs),
    /// Draw one view to a PNG.
    Render(super::render::RenderArgs),
    /// Raise any textured rectangle out of its plane by a displacement map, or draw the figures of the patent that says how.
    Relief(super::relief::ReliefArgs),
    /// Open a window and fly through a city.
    Fly(super::fly::FlyArgs),
    /// Film a flight: a video, or numbered frames.
    Film(super::film::FilmArgs),
    /// Lens prescriptions: first-order data, ghosts, exact rays, drawings.
    #[command(subcommand)]
    Lens(super::lens::LensCommand),
    /// Time the frames of some views.
    Bench(super::bench::BenchArgs),
}
