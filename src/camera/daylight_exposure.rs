//! Exposure and white that follow the daylight, as an eye or a photographer does: not all the way, so that evenings stay darker than noon.
//! It goes by the sky over the city, not by the image, so that it needs no image read back and does not flicker as the camera moves.

use glam::DVec3;

use crate::space::Sun;

/// Daylight of a high sun, at which a surface that meets it is as bright as its reflectance, times [`KEY`].
const USUAL: f64 = 3.1;
/// By how much an image is lighter than its reflectances: roofs and streets are dark, and much of a town lies in shade.
const KEY: f64 = 1.2;
/// How a town meets the sun: the part of level surfaces, and that of walls by the mean cosine of those in the sun.
const LEVEL: f64 = 0.6;
const UPRIGHT: f64 = 0.4 * 0.64;
/// How far the exposure follows, as a power: 1 would make every hour equally bright.
const FOLLOWS: f64 = 0.78;
/// Daylight below which it follows no farther: street lamps.
const DARKEST: f64 = 0.004;

/// Mean irradiance of a town's surfaces that are in the light, linear sRGB. `sky`: of level ground by the sky alone.
pub fn daylight(sun: &Sun, sky: DVec3) -> DVec3 {
    let sine = sun.to_sun.z.clamp(0.0, 1.0);
    let met = LEVEL * sine + UPRIGHT * (1.0 - sine * sine).sqrt();
    sky + sun.irradiance * met
}

/// The factor for a daylight (linear sRGB, in the image's unit).
pub fn daylight_exposure(daylight: DVec3) -> f32 {
    (KEY * ((USUAL + DARKEST) / (luminance(daylight).max(0.0) + DARKEST)).powf(FOLLOWS)) as f32
}

fn luminance(rgb: DVec3) -> f64 {
    rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// How far white follows the daylight's colour, as powers: from magenta to green, and from blue and from orange to neither. 1 would make
/// every hour's grey grey; a low sun stays warm.
const GREENS: f64 = 0.5;
const WARMS: f64 = 0.5;
const COOLS: f64 = 0.12;

/// Factors of the channels that bring a daylight nearer to white, as an eye does that has grown used to it; its luminance stays. Where lamps
/// outshine the daylight white is theirs.
pub fn white_balance(daylight: DVec3) -> [f32; 3] {
    let light = daylight.max(DVec3::ZERO) + DARKEST;
    let logarithm = light.map(f64::ln);
    let warmth = logarithm.x - logarithm.z;
    let greenness = logarithm.y - 0.5 * (logarithm.x + logarithm.z);
    let followed = if warmth > 0.0 { COOLS } else { WARMS } * warmth * DVec3::new(0.5, 0.0, -0.5)
        + GREENS * greenness * DVec3::new(-1.0, 2.0, -1.0) / 3.0;
    let factors = (-followed).exp();
    let brighter = luminance(factors * light) / luminance(light);
    (factors / brighter).as_vec3().to_array()
}

/// How much a photographer stops down who looks straight at the sun, as a factor; and the angle over which that fades, radians.
const STOPPED_DOWN: f64 = 0.15;
const FADES_OVER: f64 = 0.35;
/// Sines of the sun's altitude between which its glow counts.
const GLOW: [f64; 2] = [-0.1, 0.0];

/// The factor for a camera behind a lens that looks towards the sun, on top of that for the daylight: its glow is many times brighter
/// than the town. It goes by the angle between the two alone, so that roofs before the sun change nothing.
pub fn towards_sun_exposure(forward: DVec3, sun: &Sun) -> f32 {
    let angle = forward.angle_between(sun.to_sun);
    let rise = ((sun.to_sun.z - GLOW[0]) / (GLOW[1] - GLOW[0])).clamp(0.0, 1.0);
    let glow = rise * rise * (3.0 - 2.0 * rise) * (-(angle / FADES_OVER).powi(2)).exp();
    STOPPED_DOWN.powf(glow) as f32
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
            let exposure = f64::from(daylight_exposure(DVec3::splat(daylight)));
            let image = exposure * daylight;
            assert!(exposure >= last.1 && image <= last.0 + 1e-9, "{daylight}");
            last = (image, exposure);
        }
        assert!((f64::from(daylight_exposure(DVec3::splat(USUAL))) - KEY).abs() < 1e-3);
    }

    /// White light stays as it is; a coloured one comes nearer to white, keeps its luminance, and does not change sides.
    #[test]
    fn coloured_daylight_comes_nearer_to_white() {
        assert!(
            white_balance(DVec3::splat(2.0))
                .iter()
                .all(|factor| (factor - 1.0).abs() < 1e-6)
        );
        for daylight in [
            DVec3::new(3.0, 2.2, 1.1),
            DVec3::new(0.06, 0.05, 0.12),
            DVec3::new(0.2, 0.12, 0.16),
        ] {
            let balanced = daylight * glam::Vec3::from_array(white_balance(daylight)).as_dvec3();
            assert!(
                (luminance(balanced) / luminance(daylight) - 1.0).abs() < 0.01,
                "{daylight}"
            );
            let spread = |rgb: DVec3| rgb.max_element() / rgb.min_element();
            assert!(
                spread(balanced) < 0.97 * spread(daylight),
                "{daylight}: {balanced}"
            );
            let order = |rgb: DVec3| [rgb.x > rgb.y, rgb.y > rgb.z];
            assert_eq!(order(balanced), order(daylight), "{daylight}: {balanced}");
        }
    }
}
