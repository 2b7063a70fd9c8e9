//! Exposure that follows the daylight, as an eye or a photographer does: not all the way, so that evenings stay darker than noon.
//! It goes by the sky over the city, not by the image, so that it needs no image read back and does not flicker as the camera moves.

/// Daylight for which the exposure is 1: that of a high sun.
const USUAL: f64 = 4.0;
/// How far the exposure follows, as a power: 1 would make every hour equally bright.
const FOLLOWS: f64 = 0.78;
/// Daylight below which it follows no farther: street lamps.
const DARKEST: f64 = 0.004;

/// The factor for an irradiance of level ground under the open sky, in the image's unit.
pub fn daylight_exposure(daylight: f64) -> f32 {
    ((USUAL + DARKEST) / (daylight.max(0.0) + DARKEST)).powf(FOLLOWS) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It rises as the light falls, and never so fast that the image would brighten by it.
    #[test]
    fn darker_days_stay_darker() {
        let mut last = (f64::INFINITY, 0.0);
        for step in 0..200 {
            let daylight = 4.0 * 0.93_f64.powi(step);
            let exposure = f64::from(daylight_exposure(daylight));
            let image = exposure * daylight;
            assert!(exposure >= last.1 && image <= last.0 + 1e-9, "{daylight}");
            last = (image, exposure);
        }
        assert!((daylight_exposure(USUAL) - 1.0).abs() < 1e-3);
    }
}
