//! `rilievo sample`: the sample city's source files, or those of a made-up region of any size.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use super::CommandError;
use super::values::require_no_city;
use crate::sample::{SampleFiles, write_region, write_sample};
use crate::source::open_regular;

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

/// Smallest and largest region, square kilometres: a square of streets; what is written in minutes.
const AREAS: std::ops::RangeInclusive<f64> = 0.25..=10_000.0;

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
    let unwritten = |path: &Path| {
        let path = path.display().to_string();
        move |error: std::io::Error| CommandError::File {
            path,
            why: error.to_string(),
        }
    };
    std::fs::create_dir_all(&args.dir).map_err(unwritten(&args.dir))?;
    // Beside their places first: what lies there already may be somebody's own.
    let beside = tempfile::tempdir_in(&args.dir).map_err(unwritten(&args.dir))?;
    let made = write(args, beside.path())?;
    let names = [&made.terrain, &made.buildings].into_iter().chain(&made.imagery);
    let places = names.map(|file| (file, args.dir.join(file.file_name().unwrap_or_default())));
    let places: Vec<_> = places.collect();
    for (file, place) in &places {
        if place.symlink_metadata().is_ok() && !is_equal(file, place).map_err(unwritten(place))? {
            return Err(CommandError::File {
                path: place.display().to_string(),
                why: "exists and is another file; move it elsewhere, or name another folder".to_owned(),
            });
        }
    }
    for (file, place) in &places {
        std::fs::rename(file, place).map_err(unwritten(place))?;
    }
    let mut places = places.into_iter().map(|(_, place)| place.display().to_string());
    let (terrain, buildings) = (
        places.next().unwrap_or_default(),
        places.next().unwrap_or_default(),
    );
    let imagery: Vec<String> = places.collect();
    let photo = match imagery.is_empty() {
        true => String::new(),
        false => format!("--photo {} ", imagery.join(" ")),
    };
    say!(
        "rilievo import --terrain {terrain} --buildings {buildings} --height-field height_m {photo}--out CITY"
    );
    Ok(())
}

/// Whether two files hold the same.
fn is_equal(a: &Path, b: &Path) -> std::io::Result<bool> {
    let [a, b] = [std::fs::File::open(a)?, open_regular(b)?];
    if a.metadata()?.len() != b.metadata()?.len() {
        return Ok(false);
    }
    let [mut a, mut b] = [a, b].map(|file| BufReader::with_capacity(1 << 20, file));
    loop {
        let [left, right] = [a.fill_buf()?, b.fill_buf()?];
        let count = left.len().min(right.len());
        if left[..count] != right[..count] {
            return Ok(false);
        }
        if count == 0 {
            return Ok(true);
        }
        a.consume(count);
        b.consume(count);
    }
}

/// Writes the files into a folder.
fn write(args: &SampleArgs, folder: &Path) -> Result<SampleFiles, CommandError> {
    let files = match args.buildings.zip(args.km2) {
        Some((buildings, km2)) => {
            let (files, written) =
                write_region(folder, buildings as usize, km2).map_err(crate::city::CityError::from)?;
            if written < buildings as usize {
                return Err(CommandError::Argument(format!(
                    "{}: only {written} buildings fit on {km2} km2; give a larger --km2",
                    args.dir.display()
                )));
            }
            files
        }
        None => write_sample(folder).map_err(crate::city::CityError::from)?,
    };
    Ok(files)
}
