//! `rilievo sample`: the sample city's source files, or those of a made-up region of any size.

use std::path::PathBuf;

use super::CommandError;
use super::values::require_no_city;
use crate::sample::{write_region, write_sample};

/// Flags of `sample`.
#[derive(Debug, clap::Args)]
pub struct SampleArgs {
    /// The folder to write to.
    dir: PathBuf,
    /// A region of towns instead, with so many buildings, to measure how things grow.
    #[arg(long, requires = "km2", value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    buildings: Option<u32>,
    /// Its area, square kilometres.
    #[arg(long, requires = "buildings", value_parser = area)]
    km2: Option<f64>,
}

/// Smallest and largest region, square kilometres: a square of streets; a quarter of a UTM zone's width.
const AREAS: std::ops::RangeInclusive<f64> = 0.25..=40_000.0;

fn area(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "is not a number".to_owned())?;
    let [min, max] = [AREAS.start(), AREAS.end()];
    AREAS
        .contains(&value)
        .then_some(value)
        .ok_or_else(|| format!("must be {min} to {max}"))
}

/// Writes the files and says how to import them.
pub fn run(args: &SampleArgs) -> Result<(), CommandError> {
    require_no_city(&args.dir.join("terrain.tif"))?;
    let files = match args.buildings.zip(args.km2) {
        Some((buildings, km2)) => {
            let (files, written) =
                write_region(&args.dir, buildings as usize, km2).map_err(crate::city::CityError::from)?;
            if written < buildings as usize {
                return Err(CommandError::Argument(format!(
                    "{}: only {written} buildings fit on {km2} km2; give a larger --km2",
                    args.dir.display()
                )));
            }
            files
        }
        None => write_sample(&args.dir).map_err(crate::city::CityError::from)?,
    };
    let imagery: Vec<String> = files
        .imagery
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    let photo = match imagery.is_empty() {
        true => String::new(),
        false => format!("--photo {} ", imagery.join(" ")),
    };
    say!(
        "rilievo import --terrain {} --buildings {} --height-field height_m {photo}--out CITY",
        files.terrain.display(),
        files.buildings.display(),
    );
    Ok(())
}
