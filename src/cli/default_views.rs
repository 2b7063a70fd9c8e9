//! Views of a city where none is given.

use super::CommandError;
use crate::city::City;
use crate::output::PathKey;

/// Field of view where a view says none, degrees.
pub const DEFAULT_FOV_DEG: f64 = 60.0;

/// A low, an oblique and a high view over the centre, and one from above that shows the whole city.
pub fn default_views(city: &City, size: [u32; 2]) -> Result<Vec<PathKey>, CommandError> {
    let bounds = city.manifest().grid.bounds();
    let centre = bounds.centre();
    let tile = city.manifest().grid.tile_at(centre);
    let ground = match tile {
        Some(tile) => city.terrain(tile)?.and_then(|terrain| terrain.ground.range()),
        None => None,
    };
    let top = f64::from(ground.map_or(0.0, |[_, high]| high));
    let reach = 0.25 * bounds.width().min(bounds.height());
    // Far enough for the city's sides to fit, with a tenth to spare.
    let half_view = (0.5 * DEFAULT_FOV_DEG).to_radians().tan();
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let far = 0.55 * (bounds.height() / half_view).max(bounds.width() / (half_view * aspect));
    let view = |name: &str, back: f64, up: f64| PathKey {
        name: name.to_owned(),
        eye: [centre.x - back, centre.y - back, top + up],
        look: [centre.x, centre.y, top],
        ..PathKey::default()
    };
    Ok(vec![
        view("low", 0.4 * reach, 60.0),
        view("oblique", 0.4 * reach, 0.35 * reach),
        view("high", 0.6 * reach, 1.6 * reach),
        PathKey {
            eye: [centre.x, centre.y - 0.02 * far, top + far],
            ..view("whole", 0.0, far)
        },
    ])
}
