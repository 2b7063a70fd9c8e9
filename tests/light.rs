//! Light against truth: shadows of hills and houses against the independent ray caster, one sample against many, imagery where the
//! survey has it, and the sun behind a roof.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::path::Path;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use glam::{DVec2, DVec3};
use half::f16;
use rilievo::camera::Camera;
use rilievo::city::City;
use rilievo::gpu::{Gpu, read_texture};
use rilievo::output::{FrameRequest, Renderer, Still};
use rilievo::relief::{cast_buildings, cast_ground, is_open, sun_seen_from};
use rilievo::scene::TerrainMesh;
use rilievo::space::{SOLAR_ANGULAR_RADIUS, Sun};
use support::raycaster::{Raycaster, Truth};

const SIZE: [u32; 2] = [160, 90];

fn open(city: &Path) -> Renderer {
    Renderer::open(Gpu::open().unwrap(), &City::open(city).unwrap(), TerrainMesh::Tin).unwrap()
}

/// The sample city, loaded once for all tests.
fn renderer() -> MutexGuard<'static, Renderer> {
    static RENDERER: OnceLock<Mutex<Renderer>> = OnceLock::new();
    RENDERER
        .get_or_init(|| Mutex::new(open(&support::sample().join("city"))))
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
}

fn caster() -> Raycaster {
    let files = support::sample().join("files");
    Raycaster::open(
        &files.join("terrain.tif"),
        &files.join("buildings.gpkg"),
        "height_m",
    )
}

fn views() -> impl Iterator<Item = (&'static str, Camera)> {
    support::VIEWS
        .into_iter()
        .map(|(name, eye, target)| (name, support::pinhole(eye, target, 1.0)))
}

/// Linear radiance of the last sample, and the still.
fn radiance(renderer: &mut Renderer, camera: &Camera, sun: &Sun) -> (Vec<[f64; 3]>, Still) {
    let still = renderer.still(&support::request(camera, sun, SIZE), 1).unwrap();
    let targets = renderer.relief_targets().unwrap();
    let texels = read_texture::<[f16; 4]>(&renderer.gpu, &targets.radiance.texture).unwrap();
    let rgb = |texel: &[f16; 4]| [texel[0], texel[1], texel[2]].map(f64::from);
    (texels.iter().map(rgb).collect(), still)
}

/// Mean of all channels of an 8-bit image, decoded to linear light.
fn mean(still: &Still) -> f64 {
    let linear = |code: u8| {
        let value = f64::from(code) / 255.0;
        if value <= 0.040_45 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    };
    let sum: f64 = still
        .rgba
        .chunks_exact(4)
        .flat_map(|pixel| &pixel[..3])
        .map(|&code| linear(code))
        .sum();
    sum / (still.rgba.len() / 4 * 3) as f64
}

/// A single sample is noisier than many, and never of another brightness.
#[test]
fn one_sample_and_many_show_the_same_light() {
    let mut renderer = renderer();
    for (name, camera) in views() {
        for [azimuth, altitude] in [[225.0, 42.0], [290.0, 6.0], [120.0, 20.0]] {
            let sun = Sun::from_azimuth_altitude(azimuth, altitude);
            // Dark enough that the tone curve bends nothing: it shows bright noise darker than its mean.
            let request = FrameRequest {
                exposure: 0.2,
                ..support::request(&camera, &sun, [2 * SIZE[0], 2 * SIZE[1]])
            };
            let one = mean(&renderer.still(&request, 1).unwrap());
            let many = mean(&renderer.still(&request, 64).unwrap());
            println!("{name}, sun at {altitude} degrees: {one:.5} and {many:.5}");
            assert!((one / many - 1.0).abs() < 0.01, "{name}: {one} and {many}");
        }
    }
}

/// Which pixels the sun lights, by the difference that its light makes; against rays of the independent caster from the surface that
/// each shows. Shadows of hills, of houses, on slopes and walls.
#[test]
fn shadows_agree_with_the_ray_caster() {
    let mut renderer = renderer();
    let caster = caster();
    let (mut lit_total, mut shaded_total) = (0, 0);
    for (name, camera) in views() {
        // Not before the sun, whose glow in the haze would pass for light on what it lies before.
        for [azimuth, altitude] in [[225.0, 42.0], [300.0, 5.0], [120.0, 12.0]] {
            // A point of light, so that every shadow has one edge.
            let sun = Sun {
                angular_radius: 0.0,
                ..Sun::from_azimuth_altitude(azimuth, altitude)
            };
            let dark = Sun {
                irradiance: DVec3::ZERO,
                ..sun
            };
            let (with_sun, still) = radiance(&mut renderer, &camera, &sun);
            let (without, _) = radiance(&mut renderer, &camera, &dark);
            let projection = camera.projection(SIZE);
            let (mut checked, mut wrong) = (0, 0);
            // Every 17th pixel: the caster is slow, and neighbours tell the same.
            for k in (0..with_sun.len()).step_by(17) {
                let [column, row] = [k as u32 % SIZE[0], k as u32 / SIZE[0]];
                let t = f64::from(still.depth[k]);
                if t.is_nan() || t > 1500.0 {
                    continue;
                }
                let ray = projection.ray_direction(column, row);
                let at = camera.pose.eye + ray * t;
                // The same answer a hand's breadth to all sides: elsewhere an edge lies within a texel, or the surface turns away.
                let side = sun.to_sun.cross(DVec3::Z).normalize();
                // Off the surface by what an image of the ground may be off, and nearly on it: a low sun's shadow ends in between
                // for metres, and there neither is wrong.
                let sees = |offset: DVec3, lift: f64| {
                    let mut start = at - ray * 0.05 + lift * DVec3::Z + offset;
                    if let (0, Some(ground)) = (still.ids[k], caster.ground(start.x, start.y)) {
                        start.z = start.z.max(ground + lift);
                    }
                    matches!(caster.cast(start.to_array(), sun.to_sun.to_array()), Truth::Sky)
                };
                let mut seen: Vec<bool> = [side, -side, DVec3::Z, DVec3::ZERO]
                    .map(|offset| sees(0.5 * offset, 0.3))
                    .to_vec();
                seen.push(sees(DVec3::ZERO, 0.02));
                if seen.iter().any(|&one| one != seen[0]) {
                    continue;
                }
                let sunlight = with_sun[k][1] - without[k][1];
                // The haze before a surface glows with the sun as well, by a few hundredths.
                let is_lit = sunlight > 0.1 * with_sun[k][1];
                // How much the surface faces the sun, by what a ray meets there and by the survey's own slope.
                let hit = cast_buildings(&renderer.resident.tiles, camera.pose.eye, ray, f32::INFINITY).0;
                let normal = match hit
                    .filter(|hit| hit.fid == still.ids[k])
                    .map(|hit| hit.wall_normal)
                {
                    Some(Some(wall)) => wall.as_dvec2().extend(0.0),
                    Some(None) => DVec3::Z,
                    None => {
                        let height = |x: f64, y: f64| caster.ground(at.x + x, at.y + y).unwrap_or(at.z);
                        let slope = DVec2::new(
                            height(0.5, 0.0) - height(-0.5, 0.0),
                            height(0.0, 0.5) - height(0.0, -0.5),
                        );
                        (-slope).extend(1.0).normalize()
                    }
                };
                let facing = normal.dot(sun.to_sun);
                // What hardly faces the sun is dark in its light as well.
                if seen[0] && facing < 0.08 {
                    continue;
                }
                checked += 1;
                lit_total += u32::from(is_lit);
                shaded_total += u32::from(!is_lit);
                wrong += u32::from(is_lit != seen[0]);
            }
            println!(
                "{name}, sun at {altitude} degrees: {wrong} of {checked} lit or dark against the caster"
            );
            assert!(checked > 100, "{name}: {checked}");
            assert!(wrong * 100 <= checked, "{name}: {wrong} of {checked}");
        }
    }
    assert!(
        lit_total > 500 && shaded_total > 500,
        "{lit_total} lit, {shaded_total} shaded"
    );
}

/// Rays from any start, on the CPU: what they meet, and how far away, against the independent caster.
#[test]
fn rays_from_any_start_meet_what_the_ray_caster_meets() {
    let mut renderer = renderer();
    renderer.load_finest().unwrap();
    let caster = caster();
    let tiles = &renderer.resident.tiles;
    let centre = tiles.grid.bounds().centre();
    let (mut tried, mut met, mut wrong) = (0, 0, 0);
    let unit = |k: u32, step: f64| (f64::from(k) * step).fract();
    for k in 0..3000 {
        // Low-discrepancy starts over the town, from the ground to above its roofs, and directions all round.
        let plan = centre + (DVec2::new(unit(k, 0.754_877_67), unit(k, 0.569_840_29)) - 0.5) * 900.0;
        let Some(ground) = tiles.ground_at(plan) else {
            continue;
        };
        let start = plan.extend(ground + 0.3 + 40.0 * unit(k, 0.819_172_51));
        let azimuth = std::f64::consts::TAU * unit(k, 0.671_043_61);
        let rise = 0.9 * (unit(k, 0.549_700_5) - 0.4);
        let flat = (1.0 - rise * rise).sqrt();
        let direction = DVec3::new(azimuth.sin() * flat, azimuth.cos() * flat, rise);
        // A start inside a building is none: nothing is seen from there.
        const ABOVE_ALL: f64 = 2000.0;
        let from_above = caster.cast([plan.x, plan.y, ABOVE_ALL], [0.0, 0.0, -1.0]);
        if matches!(from_above, Truth::Building { t, .. } if ABOVE_ALL - t > start.z) {
            continue;
        }
        tried += 1;
        let truth = caster.cast(start.to_array(), direction.to_array());
        let ground = cast_ground(tiles, start, direction, f32::INFINITY).map(f64::from);
        let building = cast_buildings(tiles, start, direction, f32::INFINITY).0;
        let building = building.map(|hit| (f64::from(hit.t), hit.fid));
        let near = |a: f64, b: f64| (a - b).abs() < 0.2 + 0.002 * b;
        let same = match truth {
            Truth::Sky => ground.is_none() && building.is_none(),
            Truth::Ground { t } => ground.is_some_and(|met| near(met, t)),
            // Of two walls that touch either may be named.
            Truth::Building { t, id } => {
                building.is_some_and(|(met, fid)| near(met, t) && (fid == id || (met - t).abs() < 1e-3))
            }
        };
        assert_eq!(
            is_open(tiles, start, direction),
            ground.is_none() && building.is_none()
        );
        met += u32::from(truth != Truth::Sky);
        if !same {
            println!("{start} {direction}: {truth:?}, ground {ground:?}, building {building:?}");
        }
        wrong += u32::from(!same);
    }
    println!("{wrong} of {tried} differ, {met} met something");
    assert!(tried > 1000 && met > 600, "{tried}, {met}");
    assert!(wrong * 200 <= tried, "{wrong} of {tried} differ");
}

/// An orthophoto seen from above shows the survey's own colours at their own place: one that is turned or mirrored does not.
#[test]
fn imagery_lies_where_the_survey_has_it() {
    let mut renderer = renderer();
    let files = support::sample().join("files");
    let centre = renderer.resident.tiles.grid.bounds().centre();
    let height = renderer.resident.ground_at(centre).unwrap() + 500.0;
    let camera = support::pinhole(
        [centre.x, centre.y, height],
        [centre.x, centre.y, 0.0],
        60_f64.to_radians(),
    );
    let sun = Sun {
        angular_radius: 0.0,
        ..Sun::from_direction(DVec3::Z)
    };
    let (seen, still) = radiance(&mut renderer, &camera, &sun);
    // The survey's pixels, by GDAL alone.
    let photos: Vec<_> = ["photo_0_0", "photo_1_0", "photo_0_1", "photo_1_1"]
        .map(|name| gdal::Dataset::open(files.join(name).with_extension("tif")).unwrap())
        .into();
    let colour = |at: DVec2| {
        photos.iter().find_map(|photo| {
            let [west, dx, _, north, _, dy] = photo.geo_transform().unwrap();
            let (column, row) = (((at.x - west) / dx) as isize, ((at.y - north) / dy) as isize);
            let (width, height) = photo.raster_size();
            let is_inside =
                (3..width as isize - 3).contains(&column) && (3..height as isize - 3).contains(&row);
            is_inside.then(|| {
                let band = |index| {
                    let band = photo.rasterband(index).unwrap();
                    let window = band
                        .read_as::<u8>((column - 2, row - 2), (5, 5), (5, 5), None)
                        .unwrap();
                    window.data().iter().map(|&code| f64::from(code)).sum::<f64>() / 25.0
                };
                [band(1), band(2), band(3)]
            })
        })
    };
    // Correlation of the image's green with the survey's, as it lies, and mirrored north to south and east to west.
    let projection = camera.projection(SIZE);
    let correlation = |mirror: DVec2| {
        let mut pairs = Vec::new();
        for k in (0..seen.len()).step_by(3) {
            if still.ids[k] != 0 || still.depth[k].is_nan() {
                continue;
            }
            let ray = projection.ray_direction(k as u32 % SIZE[0], k as u32 / SIZE[0]);
            let at = (camera.pose.eye + ray * f64::from(still.depth[k])).truncate();
            if let Some(survey) = colour(centre + (at - centre) * mirror) {
                pairs.push([seen[k][1].sqrt(), survey[1]]);
            }
        }
        let count = pairs.len() as f64;
        let means = [0, 1].map(|c: usize| pairs.iter().map(|pair| pair[c]).sum::<f64>() / count);
        let product = |a: usize, b: usize| {
            pairs
                .iter()
                .map(|pair| (pair[a] - means[a]) * (pair[b] - means[b]))
                .sum::<f64>()
        };
        assert!(count > 500.0, "{count} pixels");
        product(0, 1) / (product(0, 0) * product(1, 1)).sqrt()
    };
    let [right, north_south, east_west] =
        [DVec2::ONE, DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0)].map(correlation);
    println!("as it lies {right:.3}, mirrored {north_south:.3} and {east_west:.3}");
    assert!(right > 0.75, "{right}");
    assert!(north_south < 0.5 && east_west < 0.5, "{north_south} {east_west}");
}

/// Flat roofs all face the sun alike: sunlight on them is its irradiance by the sine of its altitude, whatever the azimuth (Lambert);
/// so a wrong normal or a sun on the wrong side shows. And walls that face the sun are lit, walls that face away are not.
#[test]
fn sunlight_follows_the_surface() {
    let mut renderer = renderer();
    let (_, eye, target) = support::VIEWS[1];
    let camera = support::pinhole(eye, target, 1.0);
    let sunlight = |renderer: &mut Renderer, azimuth: f64, altitude: f64| {
        let sun = Sun {
            angular_radius: 0.0,
            irradiance: DVec3::ONE,
            ..Sun::from_azimuth_altitude(azimuth, altitude)
        };
        let dark = Sun {
            irradiance: DVec3::ZERO,
            ..sun
        };
        let (lit, still) = radiance(renderer, &camera, &sun);
        let (unlit, _) = radiance(renderer, &camera, &dark);
        let green: Vec<f64> = lit.iter().zip(&unlit).map(|(a, b)| a[1] - b[1]).collect();
        (green, still)
    };
    let (high, still) = sunlight(&mut renderer, 200.0, 80.0);
    let (low, _) = sunlight(&mut renderer, 200.0, 40.0);
    let projection = camera.projection(SIZE);
    let tiles = &renderer.resident.tiles;
    let expected = 40_f64.to_radians().sin() / 80_f64.to_radians().sin();
    let (mut roofs, mut walls) = (Vec::new(), [[0_u32; 2]; 2]);
    for k in 0..high.len() {
        let ray = projection.ray_direction(k as u32 % SIZE[0], k as u32 / SIZE[0]);
        let Some(hit) = cast_buildings(tiles, camera.pose.eye, ray, f32::INFINITY).0 else {
            continue;
        };
        if still.ids[k] != hit.fid {
            continue;
        }
        match hit.wall_normal {
            None if low[k] > 0.0 && high[k] > 0.0 => roofs.push(low[k] / high[k]),
            None => {}
            Some(normal) => {
                let azimuth = 200_f64.to_radians();
                let faces = f64::from(normal.x) * azimuth.sin() + f64::from(normal.y) * azimuth.cos();
                if faces.abs() > 0.1 {
                    walls[usize::from(faces > 0.0)][usize::from(low[k] > 0.002)] += 1;
                }
            }
        }
    }
    roofs.sort_by(f64::total_cmp);
    let median = roofs[roofs.len() / 2];
    println!(
        "roofs {median:.4}, expected {expected:.4}; walls away {:?}, towards {:?}",
        walls[0], walls[1]
    );
    assert!(roofs.len() > 100 && (median / expected - 1.0).abs() < 0.01);
    assert!(
        walls[0][1] * 100 <= walls[0][0],
        "lit walls that face away: {:?}",
        walls[0]
    );
    assert!(walls[1][1] > 50, "lit walls that face the sun: {:?}", walls[1]);
}

/// As the sun rises over a roof its visible fraction grows monotonically, and never at once.
#[test]
fn the_sun_fades_softly_behind_a_roof() {
    let mut renderer = renderer();
    renderer.load_finest().unwrap();
    let tiles = &renderer.resident.tiles;
    let (_, eye, _) = support::VIEWS[0];
    let eye = DVec3::from_array(eye);
    let mut swept = 0;
    for azimuth_deg in [0.0_f64, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0] {
        let fraction = |altitude: f64| {
            let sun = Sun::from_azimuth_altitude(azimuth_deg, altitude.to_degrees());
            sun_seen_from(tiles, eye, &sun).visible_fraction
        };
        let (mut min, mut max) = (0.0, 1.3);
        if fraction(min) > 0.0 || fraction(max) < 1.0 {
            continue;
        }
        while max - min > 1e-4 {
            let centre = 0.5 * (min + max);
            if fraction(centre) > 0.5 {
                max = centre
            } else {
                min = centre
            }
        }
        // Sixteen frames from just hidden to just free.
        let frames: Vec<f64> = (0..=16)
            .map(|frame| fraction(min + 1.15 * SOLAR_ANGULAR_RADIUS * (f64::from(frame) / 8.0 - 1.0)))
            .collect();
        // A clean edge: another roof above or beside it makes a sweep of its own.
        if frames[0] > 0.01 || frames[16] < 0.99 {
            continue;
        }
        for pair in frames.windows(2) {
            let step = pair[1] - pair[0];
            assert!(
                (-1e-9..=0.15).contains(&step),
                "azimuth {azimuth_deg}: {frames:?}"
            );
        }
        swept += 1;
    }
    assert!(swept >= 2, "the eye sees no roof's edge");
}
