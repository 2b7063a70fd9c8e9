//! Hills, a river valley and a castle hill. Local metres from the south-west corner.

use glam::DVec2;

use super::noise::{fractal_noise, value_noise};

/// East-west extent, metres.
pub const WIDTH_M: f64 = 2560.0;
/// North-south extent, metres.
pub const HEIGHT_M: f64 = 2048.0;
/// Where the old town lies.
pub const CENTRE: DVec2 = DVec2::new(1210.0, 1010.0);
/// Top of the castle hill.
pub const CASTLE: DVec2 = DVec2::new(1130.0, 1265.0);

fn smoothstep(low: f64, high: f64, value: f64) -> f64 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn river_northing(x: f64) -> f64 {
    640.0 + 150.0 * (x / 430.0 + 0.4).sin() + 55.0 * (x / 190.0 + 2.0).sin()
}

/// Signed distance from the river's centre, metres, positive to the north.
pub fn river_distance(p: DVec2) -> f64 {
    let slope = (river_northing(p.x + 1.0) - river_northing(p.x - 1.0)) / 2.0;
    (p.y - river_northing(p.x)) / (1.0 + slope * slope).sqrt()
}

/// Half the river's width, metres.
pub fn river_half_width(p: DVec2) -> f64 {
    25.0 + 6.0 * (p.x / 310.0).sin()
}

/// Level of the water, metres.
pub fn water_level(p: DVec2) -> f64 {
    203.0 - 0.0012 * p.x
}

/// A point on the river's centre line.
pub fn river_point(x: f64) -> DVec2 {
    DVec2::new(x, river_northing(x))
}

/// Bare ground, metres.
pub fn ground(p: DVec2) -> f64 {
    let distance = river_distance(p);
    let half_width = river_half_width(p);
    let away = (distance.abs() - 70.0).max(0.0);
    let steep = if distance > 0.0 { 1.0 } else { 0.72 };
    let valley = water_level(p) + 4.2 + steep * (0.034 * away + 5.2e-5 * away * away);
    let hills = (away / 420.0).min(1.5) * 26.0 * fractal_noise(p.x / 620.0, p.y / 620.0, 11);
    let knolls = (away / 150.0).min(1.0) * 1.6 * value_noise(p.x / 85.0, p.y / 85.0, 29);
    let castle_hill = 38.0
        * smoothstep(
            250.0,
            55.0,
            p.distance(CASTLE) + 18.0 * value_noise(p.x / 60.0, p.y / 60.0, 5),
        );
    let land = valley + hills + knolls + castle_hill;
    let bed = water_level(p) - 1.2 * (1.0 - (distance / half_width).powi(2)).max(0.0);
    let bank = smoothstep(half_width - 2.0, half_width + 13.0, distance.abs());
    bed + (land - bed) * bank
}

/// Steepness, metres per metre.
pub fn slope(p: DVec2) -> f64 {
    const STEP: f64 = 8.0;
    let along = |d: DVec2| (ground(p + d) - ground(p - d)) / (2.0 * STEP);
    DVec2::new(along(DVec2::new(STEP, 0.0)), along(DVec2::new(0.0, STEP))).length()
}

/// How urban a place is: 1 in the centre of town, 0 in the fields.
pub fn density(p: DVec2) -> f64 {
    let from_centre = (p - CENTRE) / DVec2::new(760.0, 560.0);
    let ragged = 0.10 * value_noise(p.x / 180.0, p.y / 180.0, 77);
    (1.12 - from_centre.length() + ragged).clamp(0.0, 1.0)
}
