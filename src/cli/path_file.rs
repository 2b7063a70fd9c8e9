//! The file of a flight: a JSON list of views, or a track of GPX or KML.

use std::path::Path;

use super::CommandError;
use crate::city::City;
use crate::output::FlightPath;
use crate::source::read_track;
use crate::space::Crs;

/// Reads a flight over a city.
///
/// # Errors
/// When the file cannot be used.
pub fn read_path(path: &Path, city: &City) -> Result<FlightPath, CommandError> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    if !matches!(ending.as_deref(), Some("gpx" | "kml" | "kmz")) {
        return Ok(FlightPath::read(path)?);
    }
    let crs = Crs::from_text(&city.manifest().crs).map_err(crate::city::CityError::from)?;
    let track = read_track(path, &crs).map_err(crate::city::CityError::from)?;
    let ground = city.ground();
    Ok(FlightPath::from_track(&track, |at| {
        ground.at(at.x, at.y).ok().flatten()
    }))
}
