//! The file of a flight: a JSON list of keys, the views that it passes. `bench` takes the same list as views.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::space::Pose;

/// One key. What a key leaves out follows the keys that say it; what none says is the film's own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathKey {
    /// A name, for people.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Seconds from the flight's begin. All keys have one or none has; then they are [`PathKey::SPACING_S`] apart.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub t: Option<f64>,
    /// Eye: easting, northing, height in the city's CRS, metres.
    pub eye: [f64; 3],
    /// A point that the camera looks at.
    pub look: [f64; 3],
    /// Vertical field of view, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fov: Option<f64>,
    /// The sun's instant, RFC 3339.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// The lens's f-number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub f_number: Option<f64>,
    /// Factor on the light before tone mapping.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f64>,
}

impl PathKey {
    /// Seconds between keys that name no time.
    pub const SPACING_S: f64 = 3.0;

    /// The key's pose.
    pub fn pose(&self) -> Pose {
        Pose::looking_at(DVec3::from_array(self.eye), DVec3::from_array(self.look))
    }
}

/// A flight: keys in the order of their times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlightPath {
    /// The keys.
    pub keys: Vec<PathKey>,
}

/// A path file cannot be used.
#[derive(Debug, Error)]
#[error("{}: {why}", path.display())]
pub struct PathError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong, and what to do.
    pub why: String,
}

/// Most keys of a path: more than a day's flight recorded four times a second.
const MAX_KEYS: usize = 500_000;
/// Farther from a CRS's origin than any place on a map, metres.
const MAX_PLACE_M: f64 = 1e9;
/// Largest path file, bytes.
const MAX_BYTES: u64 = 256 << 20;

impl FlightPath {
    /// Reads a path file.
    ///
    /// # Errors
    /// When it is no list of keys, or the keys make no flight.
    pub fn read(path: &Path) -> Result<Self, PathError> {
        let error = |why: String| PathError {
            path: path.to_owned(),
            why,
        };
        let data = std::fs::metadata(path).map_err(|why| error(why.to_string()))?;
        if !data.is_file() || data.len() > MAX_BYTES {
            return Err(error("is no file of a flight path".to_owned()));
        }
        let text = std::fs::read(path).map_err(|why| error(why.to_string()))?;
        let keys: Vec<PathKey> = serde_json::from_slice(&text).map_err(|why| {
            error(format!(
                "is no list of views ({why}); each is an object with eye, look and, if wanted, t, fov, time, f_number, exposure"
            ))
        })?;
        let flight = Self { keys };
        flight.check().map_err(error)?;
        Ok(flight)
    }

    /// Writes a path file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), PathError> {
        let lines: Result<Vec<String>, _> = self.keys.iter().map(serde_json::to_string).collect();
        let written = lines.map_err(|why| why.to_string()).and_then(|lines| {
            let text = format!("[\n  {}\n]\n", lines.join(",\n  "));
            std::fs::write(path, text).map_err(|why| why.to_string())
        });
        written.map_err(|why| PathError {
            path: path.to_owned(),
            why,
        })
    }

    /// What is wrong with the keys.
    fn check(&self) -> Result<(), String> {
        if self.keys.is_empty() {
            return Err("has no views; give one or more".to_owned());
        }
        if self.keys.len() > MAX_KEYS {
            return Err(format!("has more than {MAX_KEYS} views; thin it out"));
        }
        let timed = self.keys.iter().filter(|key| key.t.is_some()).count();
        if timed != 0 && timed != self.keys.len() {
            return Err(format!(
                "{timed} of {} views have a time t; give it to all or to none",
                self.keys.len()
            ));
        }
        let mut before = f64::NEG_INFINITY;
        for (number, key) in (1..).zip(&self.keys) {
            let values = (key.eye.iter().chain(&key.look)).chain(&key.t);
            if values
                .chain(&key.fov)
                .chain(&key.f_number)
                .chain(&key.exposure)
                .any(|value| !value.is_finite())
            {
                return Err(format!("view {number} has a number that is not finite"));
            }
            if key
                .eye
                .iter()
                .chain(&key.look)
                .any(|value| value.abs() > MAX_PLACE_M)
            {
                return Err(format!(
                    "view {number} lies on no map; give metres in the city's CRS"
                ));
            }
            if key.eye == key.look {
                return Err(format!(
                    "view {number} looks at its own eye; let look be another point"
                ));
            }
            if key.fov.is_some_and(|fov| !(0.1..=170.0).contains(&fov)) {
                return Err(format!("view {number}: fov is to be 0.1 to 170 degrees"));
            }
            if [key.f_number, key.exposure]
                .iter()
                .flatten()
                .any(|&value| value <= 0.0)
            {
                return Err(format!("view {number}: f_number and exposure are to be above 0"));
            }
            if let Some(text) = &key.time
                && let Err(why) = text.parse::<jiff::Timestamp>()
            {
                return Err(format!(
                    "view {number}: time '{text}' is none ({why}); write it like 2026-06-21T19:40:00+02:00"
                ));
            }
            if let Some(t) = key.t {
                if t <= before {
                    return Err(format!("view {number}: t does not come after the view before"));
                }
                before = t;
            }
        }
        Ok(())
    }

    /// Seconds of the keys.
    pub fn times(&self) -> impl Iterator<Item = f64> {
        (0..)
            .zip(&self.keys)
            .map(|(k, key)| key.t.unwrap_or(PathKey::SPACING_S * f64::from(k)))
    }
}
