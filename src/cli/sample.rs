//! `rilievo sample`: the sample city's source files.

use std::path::PathBuf;

use super::CommandError;
use crate::sample::write_sample;
use crate::source::silence_gdal;

/// Flags of `sample`.
#[derive(Debug, clap::Args)]
pub struct SampleArgs {
    /// The folder to write to.
    dir: PathBuf,
}

/// Writes the files and says how to import them.
pub fn run(args: &SampleArgs) -> Result<(), CommandError> {
    silence_gdal();
    let files = write_sample(&args.dir).map_err(crate::city::CityError::from)?;
    let imagery: Vec<String> = files
        .imagery
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    say!(
        "rilievo import --terrain {} --buildings {} --height-field height_m --photo {} --out CITY",
        files.terrain.display(),
        files.buildings.display(),
        imagery.join(" ")
    );
    Ok(())
}
