//! Pitched roofs: which way their slopes face, told by the light of four suns, against the edges of the outlines.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::f64::consts::FRAC_PI_4;
use std::path::Path;

use glam::DVec2;
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::Renderer;
use rilievo::scene::TerrainMesh;
use rilievo::space::Sun;
use support::survey::Raster;

/// West and north edge of the survey, EPSG:32633; its side, metres; the elevation of its level ground.
const CORNER: [f64; 2] = [300_000.0, 4_800_000.0];
const SIDE_M: f64 = 1600.0;
const GROUND_M: f64 = 50.0;
const HEIGHT_M: f64 = 6.0;
const SIZE: [u32; 2] = [240, 240];
/// Metres that the image is wide, and of the eye above the roofs.
const WIDE_M: f64 = 36.0;
const ABOVE_M: f64 = 150.0;

/// A house: rings about a place, without the closing point, turned by an angle.
struct House {
    name: &'static str,
    centre: DVec2,
    rings: Vec<Vec<DVec2>>,
}

impl House {
    fn new(name: &'static str, centre: DVec2, angle: f64, rings: &[&[[f64; 2]]]) -> Self {
        let turned = |point: &[f64; 2]| centre + DVec2::from_angle(angle).rotate(DVec2::from_array(*point));
        Self {
            name,
            centre,
            rings: rings
                .iter()
                .map(|ring| ring.iter().map(turned).collect())
                .collect(),
        }
    }

    fn feature(&self) -> String {
        let rings = self.rings.iter().map(|ring| {
            let closed = ring
                .iter()
                .chain(&ring[..1])
                .map(|point| format!("[{},{}]", point.x, point.y));
            format!("[{}]", closed.collect::<Vec<_>>().join(","))
        });
        let rings = rings.collect::<Vec<_>>().join(",");
        format!(
            r#"{{"type":"Feature","properties":{{"height":{HEIGHT_M}}},"geometry":{{"type":"Polygon","coordinates":[{rings}]}}}}"#
        )
    }

    /// Edges as begin and end.
    fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        let of_ring = |ring: &Vec<DVec2>| {
            (0..ring.len())
                .map(|k| [ring[k], ring[(k + 1) % ring.len()]])
                .collect::<Vec<_>>()
        };
        self.rings
            .iter()
            .flat_map(of_ring)
            .collect::<Vec<_>>()
            .into_iter()
    }

    fn contains(&self, point: DVec2) -> bool {
        let crosses = |[a, b]: &[DVec2; 2]| {
            (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        self.edges().filter(crosses).count() % 2 == 1
    }

    /// The way down of the slope over a place: to the foot of its perpendicular on the nearest edge. None outside, near the eaves, near
    /// another slope, and where the nearest point of the outline is a corner that juts in.
    fn fall(&self, point: DVec2) -> Option<DVec2> {
        const CLEAR_M: f64 = 0.7;
        if !self.contains(point) {
            return None;
        }
        let feet = self.edges().map(|[a, b]| {
            let u = (point - a).dot(b - a) / (b - a).length_squared();
            let foot = a + u.clamp(0.0, 1.0) * (b - a);
            (foot - point, (0.0..=1.0).contains(&u))
        });
        let mut feet: Vec<(DVec2, bool)> = feet.collect();
        feet.sort_by(|a, b| a.0.length().total_cmp(&b.0.length()));
        let (nearest, is_perpendicular) = feet[0];
        let other = feet.iter().find(|(foot, _)| foot.angle_to(nearest).abs() > 0.1)?;
        let is_clear = nearest.length() > CLEAR_M && other.0.length() - nearest.length() > CLEAR_M;
        (is_clear && is_perpendicular).then(|| nearest.normalize())
    }
}

fn import(folder: &Path, houses: &[House]) -> City {
    let path = |name: &str| folder.join(name).display().to_string();
    let raster = Raster {
        epsg: 32633,
        corner: CORNER,
        pixel: [8.0; 2],
        size: [(SIDE_M / 8.0) as usize; 2],
    };
    raster.write(Path::new(&path("dtm.tif")), |_, _| GROUND_M as f32, None);
    let features: Vec<String> = houses.iter().map(House::feature).collect();
    let text = format!(
        r#"{{"type":"FeatureCollection","features":[{}]}}"#,
        features.join(",")
    );
    std::fs::write(path("houses.geojson"), text).unwrap();
    std::fs::write(
        path("rules.toml"),
        "[[rule]]\nfacades = ['house']\nroofs = ['slate']\n",
    )
    .unwrap();
    support::succeed(&[
        "import",
        "--terrain",
        &path("dtm.tif"),
        "--buildings",
        &path("houses.geojson"),
        "--buildings-crs",
        "EPSG:32633",
        "--height-field",
        "height",
        "--facades",
        &path("rules.toml"),
        "--out",
        &path("city"),
    ]);
    City::open(&folder.join("city")).unwrap()
}

#[test]
fn slopes_face_the_nearest_edge_of_the_outline() {
    let folder = tempfile::tempdir().unwrap();
    let place = |x: f64, y: f64| DVec2::from_array(CORNER) + DVec2::new(x, y - SIDE_M);
    let block: &[[f64; 2]] = &[[-9.0, -5.0], [9.0, -5.0], [9.0, 5.0], [-9.0, 5.0]];
    let ell: &[[f64; 2]] = &[
        [-8.0, -8.0],
        [10.0, -8.0],
        [10.0, 0.0],
        [0.0, 0.0],
        [0.0, 10.0],
        [-8.0, 10.0],
    ];
    let square: &[[f64; 2]] = &[[-14.0, -12.0], [14.0, -12.0], [14.0, 12.0], [-14.0, 12.0]];
    let court: &[[f64; 2]] = &[[-5.0, -4.0], [-5.0, 4.0], [5.0, 4.0], [5.0, -4.0]];
    let mut houses = vec![
        House::new("block", place(200.0, 300.0), 0.4, &[block]),
        House::new("corner", place(300.0, 300.0), 1.1, &[ell]),
        House::new("court", place(400.0, 300.0), 0.2, &[square, court]),
    ];
    // One more over the corner of four tiles, which have a part of its outline each.
    let manifest = import(folder.path(), &houses).manifest().clone();
    let [x, y] = [manifest.grid.west, manifest.grid.south].map(|edge| edge + manifest.grid.tile_m);
    houses.push(House::new(
        "crossing",
        DVec2::new(x + 2.0, y + 1.0),
        0.4,
        &[block],
    ));
    houses.push(House::new(
        "crossing court",
        DVec2::new(x + 1.0, y + manifest.grid.tile_m / 2.0),
        0.2,
        &[square, court],
    ));
    let city = import(folder.path(), &houses);
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    for house in &houses {
        let roof_m = GROUND_M + HEIGHT_M;
        let eye = house.centre.extend(roof_m + ABOVE_M).to_array();
        let target = (house.centre + DVec2::new(0.0, 1e-3)).extend(roof_m).to_array();
        let camera = support::pinhole(eye, target, 2.0 * (0.5 * WIDE_M / ABOVE_M).atan());
        let mut green = |azimuth: f64| -> Vec<f64> {
            let sun = Sun::from_azimuth_altitude(azimuth, 50.0);
            let radiance = support::radiance(&mut renderer, &support::request(&camera, &sun, SIZE), 4);
            radiance.iter().map(|rgb| f64::from(rgb[1])).collect()
        };
        let [ne, se, sw, nw] = [45.0, 135.0, 225.0, 315.0].map(&mut green);
        let (mut seen, mut right) = (0, 0);
        for k in 0..ne.len() {
            let [column, row] = [k as u32 % SIZE[0], k as u32 / SIZE[0]].map(|place| f64::from(place) + 0.5);
            let offset =
                DVec2::new(column / f64::from(SIZE[0]) - 0.5, 0.5 - row / f64::from(SIZE[1])) * WIDE_M;
            let Some(fall) = house.fall(house.centre + offset) else {
                continue;
            };
            // A surface is lighter by the sun that it faces.
            let facing = (ne[k] - sw[k]) * DVec2::from_angle(FRAC_PI_4)
                + (se[k] - nw[k]) * DVec2::from_angle(-FRAC_PI_4);
            let mean = 0.25 * (ne[k] + se[k] + sw[k] + nw[k]);
            seen += 1;
            right += u32::from(facing.angle_to(fall).abs() < 0.4 && facing.length() > 0.3 * mean);
        }
        println!("{}: {right} of {seen} pixels face their eaves", house.name);
        // A tile has the edges alone that touch it: slopes from the others are missing near its border.
        let gate = if house.name.starts_with("crossing") {
            88
        } else {
            97
        };
        assert!(
            seen > 1500 && right * 100 >= seen * gate,
            "{}: {right} of {seen}",
            house.name
        );
    }
}
