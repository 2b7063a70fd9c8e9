//! The sun's place in the sky against independent ephemerides.
#![allow(clippy::unwrap_used)]

use rilievo::space::{Place, sun_direction_in_world};

/// Azimuth and altitude above a sea-level horizon without refraction, degrees; a vector, as azimuths near the zenith say little.
fn off_deg(time: &str, latitude_deg: f64, longitude_deg: f64, azimuth_deg: f64, altitude_deg: f64) -> f64 {
    let place = Place {
        latitude_deg,
        longitude_deg,
        grid_north_deg: 0.0,
    };
    let to_sun = sun_direction_in_world(time, place).unwrap();
    let (azimuth, altitude) = (azimuth_deg.to_radians(), altitude_deg.to_radians());
    let expected = glam::DVec3::new(
        azimuth.sin() * altitude.cos(),
        azimuth.cos() * altitude.cos(),
        altitude.sin(),
    );
    to_sun.angle_between(expected).to_degrees()
}

/// Reda & Andreas 2004 (NREL/TP-560-34302), appendix A.5: Golden, Colorado.
#[test]
fn the_sun_stands_where_the_published_example_has_it() {
    let off = off_deg(
        "2003-10-17T12:30:30-07:00",
        39.742_476,
        -105.178_6,
        194.340_24,
        39.872_05,
    );
    assert!(off < 0.01, "{off}");
}

/// Ten dates and places by astropy 8.0.2 (ERFA, the IAU's SOFA routines: precession and nutation 2006/2000A, parallax), `get_body` to
/// `AltAz` with pressure 0: time, latitude, longitude, azimuth, altitude.
#[test]
fn the_sun_stands_where_the_ephemeris_has_it() {
    for (time, latitude, longitude, azimuth, altitude) in [
        ("2026-06-21T17:40:00Z", 43.08, 12.41, 291.9075, 10.9891),
        ("2026-12-21T12:00:00Z", 51.4779, 0.0, 180.4592, 15.0816),
        ("2024-03-20T03:06:00Z", 0.0, 0.0, 89.9999, -45.3564),
        ("2000-01-01T12:00:00Z", 35.68, 139.69, 278.1315, -52.3049),
        ("2025-09-22T18:30:00Z", -33.87, 151.21, 101.1214, -16.0304),
        ("2015-08-09T05:15:00Z", 64.13, -21.9, 52.3785, 0.5253),
        ("1999-08-11T11:03:00Z", 48.14, 11.58, 172.9333, 57.0226),
        ("2021-05-05T20:00:00Z", 34.1, -118.33, 187.9064, 72.2461),
        ("2010-11-15T09:45:00Z", -34.03, 20.44, 30.8774, 72.3294),
        ("2005-02-28T16:20:00Z", -77.85, 166.67, 132.0386, -0.3563),
    ] {
        let off = off_deg(time, latitude, longitude, azimuth, altitude);
        println!("{time}: {off:.5} degrees");
        assert!(off < 0.01, "{time}: {off}");
    }
}
