//! Coordinates as people read and write them: in the city's CRS, and in degrees.

use glam::{DVec2, DVec3};

use crate::space::{Bounds, Crs, CrsError, PointTransform};

/// The ways between the city's CRS and the globe (WGS 84).
pub struct Places {
    to_globe: PointTransform,
    from_globe: PointTransform,
    bounds: Bounds,
}

impl Places {
    /// Of a city in a CRS.
    ///
    /// # Errors
    /// When PROJ knows no way to the globe.
    pub fn new(crs: &str, bounds: Bounds) -> Result<Self, CrsError> {
        let (own, globe) = (Crs::from_text(crs)?, Crs::wgs84()?);
        Ok(Self {
            to_globe: PointTransform::new(&own, &globe)?,
            from_globe: PointTransform::new(&globe, &own)?,
            bounds,
        })
    }

    /// A point's easting, northing and height, and its latitude and longitude.
    pub fn label(&self, point: DVec3) -> String {
        let own = format!("E {:.2}  N {:.2}  H {:.2} m", point.x, point.y, point.z);
        let Some(globe) = self.to_globe.point(point.truncate()) else {
            return own;
        };
        let half = |degrees: f64, signs: [char; 2]| {
            format!("{:.6}° {}", degrees.abs(), signs[usize::from(degrees < 0.0)])
        };
        format!(
            "{own}    {}  {}",
            half(globe.y, ['N', 'S']),
            half(globe.x, ['E', 'W'])
        )
    }

    /// A point of the city from what somebody wrote: easting and northing, or latitude and longitude in degrees.
    pub fn parse(&self, text: &str) -> Option<DVec2> {
        let signed = |part: &str| {
            let part = part.trim().trim_end_matches('°');
            let letter = part.chars().last()?.to_ascii_uppercase();
            let number = part
                .trim_end_matches(|c: char| c.is_alphabetic())
                .trim()
                .trim_end_matches('°');
            let number = number.trim_start_matches(|c: char| c.is_alphabetic() || c == ' ');
            let value: f64 = number.parse().ok()?;
            Some(if matches!(letter, 'S' | 'W') {
                -value
            } else {
                value
            })
        };
        let parts: Vec<&str> = match text.contains(',') {
            true => text.split(',').collect(),
            false => text.split_whitespace().collect(),
        };
        let numbers: Option<Vec<f64>> = parts.into_iter().take(2).map(signed).collect();
        let [first, second] = *numbers?.as_slice() else {
            return None;
        };
        let own = DVec2::new(first, second);
        let is_inside = self.bounds.distance_to(own) == 0.0;
        let is_globe = first.abs() <= 90.0 && second.abs() <= 180.0;
        match is_globe && !is_inside {
            true => self.from_globe.point(DVec2::new(second, first)),
            false => Some(own),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_can_be_written_back() -> Result<(), CrsError> {
        let bounds = Bounds {
            west: 690_000.0,
            south: 5_333_000.0,
            east: 694_000.0,
            north: 5_337_000.0,
        };
        let places = Places::new("EPSG:25832", bounds)?;
        let point = DVec3::new(691_000.0, 5_335_000.0, 520.0);
        let label = places.label(point);
        assert!(
            label.starts_with("E 691000.00  N 5335000.00  H 520.00 m"),
            "{label}"
        );
        let near = |text: &str, x: f64, y: f64, off: f64| {
            let found = places.parse(text);
            assert!(
                found.is_some_and(|at| at.distance(DVec2::new(x, y)) < off),
                "{text}: {found:?}"
            );
        };
        // Munich's Marienplatz.
        near("48.1372, 11.5755", 691_607.0, 5_334_760.0, 60.0);
        near(
            "48.1372 N 11.5755 E"
                .replace(" N", "N")
                .replace(" E", "E")
                .as_str(),
            691_607.0,
            5_334_760.0,
            60.0,
        );
        near("691500, 5334000", 691_500.0, 5_334_000.0, 1e-9);
        near("691500 5334000", 691_500.0, 5_334_000.0, 1e-9);
        let (_, globe) = label.split_once("m    ").unwrap_or_default();
        let written = globe.replace("  ", ", ");
        near(&written, 691_000.0, 5_335_000.0, 0.2);
        assert_eq!(places.parse("somewhere"), None);
        assert_eq!(places.parse("12"), None);
        Ok(())
    }
}
