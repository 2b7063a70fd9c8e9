//! How the linear and the nonlinear image of a ghost come together (KR 10-1658883).

use glam::DVec2;

use super::grid::RayGrid;
use super::linear::LinearGhost;
use super::nonlinearity::LINEAR_ENOUGH;
use super::quad::Losses;

/// The ways to blend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Blend {
    /// Each ghost is drawn one way, and all are added.
    #[default]
    Add,
    /// Each ghost fades from its linear to its nonlinear image by its nonlinearity error, so that none changes at once.
    Interpolate,
    /// Linear images of all, and the nonlinear ones blended over them, as opaque as they are nonlinear.
    Alpha,
}

/// What of a nonlinear ghost is fitted to its linear image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fit {
    /// Its size on the sensor.
    pub size: bool,
    /// Its light.
    pub brightness: bool,
}

/// Fractions of the linear and the nonlinear image of a ghost with a nonlinearity error.
pub fn fractions(blend: Blend, nonlinearity_error: f64) -> [f64; 2] {
    let fade = ((nonlinearity_error / LINEAR_ENOUGH - 0.5) / 1.5).clamp(0.0, 1.0);
    let smooth = fade * fade * (3.0 - 2.0 * fade);
    match blend {
        Blend::Add if nonlinearity_error > LINEAR_ENOUGH => [0.0, 1.0],
        Blend::Add => [1.0, 0.0],
        Blend::Interpolate => [1.0 - smooth, smooth],
        Blend::Alpha => [1.0, smooth],
    }
}

/// Light, centre and spread of points with weights.
struct Moments {
    light: f64,
    centre: DVec2,
    spread: f64,
}

impl Moments {
    fn from_points(points: &[(DVec2, f64)]) -> Option<Self> {
        let light: f64 = points.iter().map(|(_, weight)| weight).sum();
        let centre = points.iter().map(|(at, weight)| *at * *weight).sum::<DVec2>() / light;
        let square: f64 = points
            .iter()
            .map(|(at, weight)| (*at - centre).length_squared() * weight)
            .sum();
        let spread = (square / light).sqrt();
        (light > 0.0 && spread > 0.0).then_some(Self {
            light,
            centre,
            spread,
        })
    }
}

/// Fits a ghost's rays to its linear image: the spread (root mean square distance from the centre) by scaling about the
/// centre, the light by a factor on the power. As it is where either image is empty.
pub fn fitted(mut grid: RayGrid, linear: &LinearGhost, losses: &Losses, fit: Fit) -> RayGrid {
    let (mut traced, mut ideal) = (Vec::new(), Vec::new());
    for (k, ray) in grid.rays.iter().enumerate() {
        let entry = grid.entry(k);
        if linear.stop(entry).length() <= linear.stop_mm && entry.length() <= linear.barrel_mm {
            ideal.push((linear.sensor(entry), losses.power_at(entry)));
        }
        if let Some(ray) = ray
            && ray.relative_height <= 1.0
            && ray.stop_mm.length() <= linear.stop_mm
        {
            traced.push((ray.sensor_mm, ray.power));
        }
    }
    let (Some(traced), Some(ideal)) = (Moments::from_points(&traced), Moments::from_points(&ideal)) else {
        return grid;
    };
    for ray in grid.rays.iter_mut().flatten() {
        if fit.size {
            ray.sensor_mm = traced.centre + (ray.sensor_mm - traced.centre) * (ideal.spread / traced.spread);
        }
        if fit.brightness {
            ray.power *= ideal.light / traced.light;
        }
    }
    grid
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Far below the limit the linear image, far beyond it the nonlinear one; between them both fade, and alpha keeps the linear one below.
    #[test]
    fn fractions_pass_from_linear_to_nonlinear() {
        let at = |blend, error: f64| fractions(blend, error * LINEAR_ENOUGH);
        assert_eq!(
            [at(Blend::Add, 0.9), at(Blend::Add, 1.1)],
            [[1.0, 0.0], [0.0, 1.0]]
        );
        assert_eq!(
            [at(Blend::Interpolate, 0.0), at(Blend::Interpolate, 9.0)],
            [[1.0, 0.0], [0.0, 1.0]]
        );
        assert_eq!(
            [at(Blend::Alpha, 0.0), at(Blend::Alpha, 9.0)],
            [[1.0, 0.0], [1.0, 1.0]]
        );
        let mut before = 0.0;
        for step in 0..=20 {
            let error = 0.1 * f64::from(step);
            let [linear, nonlinear] = at(Blend::Interpolate, error);
            assert!((linear + nonlinear - 1.0).abs() < 1e-12 && nonlinear >= before);
            assert_eq!(at(Blend::Alpha, error), [1.0, nonlinear]);
            before = nonlinear;
        }
    }
}
