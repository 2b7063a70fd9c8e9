//! Where the sun stands, from date, time and place (SPA, Reda & Andreas 2004, by `solar-positioning`).

use glam::DVec3;
use serde::{Deserialize, Serialize};
use solar_positioning::{Location, SolarPositions, delta_t, time::JulianDate};
use thiserror::Error;

/// A place on the globe and how its grid is turned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Azimuth of grid north, degrees clockwise from true north (minus the meridian convergence).
    pub grid_north_deg: f64,
}

/// Why the sun could not be placed.
#[derive(Debug, Error)]
pub enum SunError {
    /// The text is not an RFC 3339 time.
    #[error("'{text}' is no time: {why}; write it like 2026-06-21T19:40:00+02:00")]
    Time {
        /// What was given.
        text: String,
        /// What the parser said.
        why: String,
    },
    /// The position could not be computed (year out of range).
    #[error("no sun position at '{text}': {why}")]
    Position {
        /// What was given.
        text: String,
        /// What the library said.
        why: String,
    },
}

/// Unit vector towards the sun (east, north, up of the city's grid) at an RFC 3339 time.
pub fn sun_direction_in_world(time: &str, place: Place) -> Result<DVec3, SunError> {
    let instant: jiff::Timestamp = time.parse().map_err(|error: jiff::Error| SunError::Time {
        text: time.to_owned(),
        why: error.to_string(),
    })?;
    sun_direction_at(instant, place)
}

/// The same at an instant.
///
/// # Errors
/// When its year is too far away.
pub fn sun_direction_at(instant: jiff::Timestamp, place: Place) -> Result<DVec3, SunError> {
    let position_error = |why: String| SunError::Position {
        text: instant.to_string(),
        why,
    };
    let utc = instant.to_zoned(jiff::tz::TimeZone::UTC);
    let seconds = f64::from(utc.second()) + f64::from(utc.subsec_nanosecond()) * 1e-9;
    let delta_t = delta_t::estimate(f64::from(utc.year()) + (f64::from(utc.month()) - 0.5) / 12.0)
        .map_err(|error| position_error(error.to_string()))?;
    let julian = JulianDate::from_utc(
        i32::from(utc.year()),
        utc.month() as u32,
        utc.day() as u32,
        utc.hour() as u32,
        utc.minute() as u32,
        seconds,
        delta_t,
    )
    .map_err(|error| position_error(error.to_string()))?;
    let location = Location {
        latitude: place.latitude_deg,
        longitude: place.longitude_deg,
    };
    let sun = SolarPositions::new()
        .at_from_julian(julian, location, 0.0, None)
        .map_err(|error| position_error(error.to_string()))?;
    Ok(direction_from_azimuth_altitude(
        sun.azimuth() - place.grid_north_deg,
        sun.elevation_angle(),
    ))
}

/// Unit vector (east, north, up) from a compass azimuth, degrees clockwise from grid north, and an altitude, degrees.
pub fn direction_from_azimuth_altitude(azimuth_deg: f64, altitude_deg: f64) -> DVec3 {
    let (azimuth, altitude) = (azimuth_deg.to_radians(), altitude_deg.to_radians());
    DVec3::new(
        azimuth.sin() * altitude.cos(),
        azimuth.cos() * altitude.cos(),
        altitude.sin(),
    )
}
