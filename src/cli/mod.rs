//! The command line: the public interface that scripts rely on.

/// `println!` that leaves quietly when nobody reads any more.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write;
        if let Err(error) = writeln!(std::io::stdout(), $($text)*) {
            std::process::exit(i32::from(error.kind() != std::io::ErrorKind::BrokenPipe));
        }
    }};
}

mod advice;
mod args;
mod bench;
mod bench_flare;
mod camera_flags;
mod default_views;
mod film;
mod flare_flags;
mod fly;
mod import;
mod import_report;
mod info;
mod path_file;
mod pool_flags;
mod lens;
mod lens_bake;
mod lens_flags;
mod lens_flare;
mod lens_trace;
mod relief;
mod relief_figures;
mod relief_flags;
mod render;
mod sample;
mod search_flags;
mod statistics;
mod update;
mod values;

use std::process::ExitCode;

use clap::Parser;
use thiserror::Error;

pub use args::{Args, Command};

/// What ends a command.
#[derive(Debug, Error)]
pub enum CommandError {
    /// A city could not be made or opened.
    #[error(transparent)]
    City(#[from] crate::city::CityError),
    /// A picture could not be made.
    #[error(transparent)]
    Render(#[from] crate::output::RenderError),
    /// A picture file could not be written.
    #[error(transparent)]
    Output(#[from] crate::output::OutputError),
    /// A flight path could not be used.
    #[error(transparent)]
    Path(#[from] crate::output::PathError),
    /// The sun could not be placed.
    #[error(transparent)]
    Sun(#[from] crate::space::SunError),
    /// The window could not be opened.
    #[error(transparent)]
    Viewer(#[from] crate::viewer::ViewerError),
    /// A lens could not be read.
    #[error(transparent)]
    Lens(#[from] crate::camera::lens::LensError),
    /// A flare table could not be used.
    #[error(transparent)]
    Table(#[from] crate::camera::flare::TableError),
    /// An argument that fits its form but not its subject.
    #[error("{0}")]
    Argument(String),
    /// A file could not be written.
    #[error("{path}: {why}")]
    File {
        /// The file.
        path: String,
        /// What the system said.
        why: String,
    },
}

/// Parses, runs, and turns the outcome into an exit status: 0 done, 1 failed with one line, 2 wrong usage.
pub fn main() -> ExitCode {
    let args = Args::parse();
    tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_max_level(if args.verbose {
            tracing::Level::DEBUG
        } else {
            tracing::Level::WARN
        })
        .without_time()
        .init();
    crate::source::silence_gdal();
    match run(args.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let advice = advice::for_error(&error).map(|advice| format!("; {advice}"));
            eprintln!(
                "rilievo: {}{}",
                one_line(&error.to_string()),
                advice.unwrap_or_default()
            );
            ExitCode::FAILURE
        }
    }
}

/// Most characters of a message: what a library cites of a damaged file may be long.
const MAX_CHARACTERS: usize = 1000;

fn one_line(text: &str) -> String {
    let line = text.replace(char::is_control, " ");
    match line.char_indices().nth(MAX_CHARACTERS) {
        Some((end, _)) => format!("{} ..", &line[..end]),
        None => line,
    }
}

fn run(command: Command) -> Result<(), CommandError> {
    match command {
        Command::Import(args) => import::run(args),
        Command::Update(args) => update::run(args),
        Command::Sample(args) => sample::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Relief(args) => relief::run(&args),
        Command::Fly(args) => fly::run(&args),
        Command::Film(args) => film::run(&args),
        Command::Lens(command) => lens::run(command),
        Command::Bench(args) => bench::run(&args),
    }
}
