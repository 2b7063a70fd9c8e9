//! Image-based extrusion displacement mapping (KR 10-0738500) against truth: rays against a box, and the search over a city against the
//! exact walk.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use glam::{DVec2, DVec3};
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::{FrameRequest, Renderer};
use rilievo::relief::extrusion::{
    Extrusion, ExtrusionMethod, FIGURES, HeightImage, Overflow, TextureImage, draw_extrusion, draw_figure,
};
use rilievo::relief::{ReliefMode, ReliefSettings, SearchParameters};
use rilievo::scene::TerrainMesh;
use rilievo::space::{Pose, Projection, Sun};

const SIDE: u32 = 128;
const SIZE: [u32; 2] = [160, 120];
const SQUARE_M: f64 = 20.0;
const HEIGHT_M: f64 = 9.0;
/// The box: west, south, east, north, metres. On the map's own texels.
const BOX: [f64; 4] = [6.25, 5.0, 15.0, 13.75];

fn places() -> impl Iterator<Item = [f64; 2]> {
    let metres = |count: u32| (f64::from(count) + 0.5) / f64::from(SIDE) * SQUARE_M;
    (0..SIDE * SIDE).map(move |k| [metres(k % SIDE), SQUARE_M - metres(k / SIDE)])
}

fn in_box([x, y]: [f64; 2]) -> bool {
    (BOX[0]..BOX[2]).contains(&x) && (BOX[1]..BOX[3]).contains(&y)
}

/// Green ground, a red box; blue tells how far east.
fn texture() -> TextureImage {
    let colour = |place: [f64; 2]| {
        let east = (255.0 * place[0] / SQUARE_M) as u8;
        if in_box(place) {
            [255, 0, east, 255]
        } else {
            [0, 255, east, 255]
        }
    };
    TextureImage {
        size: [SIDE; 2],
        rgba: places().map(colour).collect(),
    }
}

fn map(height: impl Fn([f64; 2]) -> f64) -> HeightImage {
    HeightImage {
        size: [SIDE; 2],
        values: places().map(|place| height(place) as f32).collect(),
    }
}

fn magenta() -> TextureImage {
    TextureImage {
        size: [1, 1],
        rgba: vec![[255, 0, 255, 255]],
    }
}

struct Scene {
    texture: TextureImage,
    height: HeightImage,
    facade: TextureImage,
    gpu: Gpu,
}

impl Scene {
    fn new(height: impl Fn([f64; 2]) -> f64) -> Self {
        Self {
            texture: texture(),
            height: map(height),
            facade: magenta(),
            gpu: Gpu::open().unwrap(),
        }
    }

    fn a_box() -> Self {
        Self::new(|place| f64::from(u8::from(in_box(place))))
    }

    fn draw(
        &self,
        projection: &Projection,
        method: ExtrusionMethod,
        overflow: Overflow,
        search: SearchParameters,
    ) -> Vec<[u8; 4]> {
        let extrusion = Extrusion {
            texture: &self.texture,
            height: &self.height,
            facade: &self.facade,
            size_m: DVec2::splat(SQUARE_M),
            height_m: HEIGHT_M,
            facade_m: 1.0,
            method,
            overflow,
            search,
        };
        let pixels = draw_extrusion(&self.gpu, &extrusion, projection).unwrap();
        pixels.as_chunks::<4>().0.to_vec()
    }
}

fn fine() -> SearchParameters {
    SearchParameters {
        slices: 512,
        ..SearchParameters::default()
    }
}

fn view(eye: [f64; 3]) -> Projection {
    let pose = Pose::looking_at(DVec3::from_array(eye), DVec3::new(10.0, 10.0, 2.0));
    Projection::new(pose, SIZE, 40_f64.to_radians())
}

/// Before a corner, before a side, high up, low down.
const EYES: [[f64; 3]; 5] = [
    [-15.0, -22.0, 20.0],
    [10.5, -26.0, 16.0],
    [38.0, 30.0, 26.0],
    [12.0, 5.0, 45.0],
    [-24.0, 8.0, 11.0],
];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Met {
    Box,
    Ground,
    Nothing,
}

/// What a ray meets: the box from the plane to its height, the rectangle, nothing. And how far away.
fn truth(eye: DVec3, ray: DVec3) -> (Met, f64) {
    let (low, high) = (
        DVec3::new(BOX[0], BOX[1], 0.0),
        DVec3::new(BOX[2], BOX[3], HEIGHT_M),
    );
    let (a, b) = ((low - eye) / ray, (high - eye) / ray);
    let (t_in, t_out) = (a.min(b).max_element(), a.max(b).min_element());
    if t_in <= t_out && t_in > 0.0 {
        return (Met::Box, t_in);
    }
    let t = -eye.z / ray.z;
    let at = eye + t * ray;
    let is_on = (0.0..SQUARE_M).contains(&at.x) && (0.0..SQUARE_M).contains(&at.y);
    if t > 0.0 && is_on {
        (Met::Ground, t)
    } else {
        (Met::Nothing, t)
    }
}

fn seen([r, g, _, _]: [u8; 4]) -> Met {
    match (r > 60, g > 200) {
        (true, false) => Met::Box,
        (false, true) => Met::Ground,
        _ => Met::Nothing,
    }
}

/// Pixels that show something else than their ray meets.
fn wrong(projection: &Projection, image: &[[u8; 4]]) -> usize {
    let is_wrong = |k: &usize| {
        let ray = projection.ray_direction(*k as u32 % SIZE[0], *k as u32 / SIZE[0]);
        truth(projection.pose.eye, ray).0 != seen(image[*k])
    };
    (0..image.len()).filter(is_wrong).count()
}

/// On the rectangle, over its borders on one face or two, and nothing besides: the added faces are not seen (claims 1, 5, 8).
#[test]
fn a_box_is_where_rays_meet_it() {
    let scene = Scene::a_box();
    for eye in EYES {
        let projection = view(eye);
        let image = scene.draw(&projection, ExtrusionMethod::Raised, Overflow::Faces, fine());
        let (wrong, boxes) = (
            wrong(&projection, &image),
            image.iter().filter(|&&p| seen(p) == Met::Box).count(),
        );
        println!(
            "from {eye:?}: {wrong} of {} pixels wrong, {boxes} show the box",
            image.len()
        );
        assert!(boxes > 800 && wrong * 100 <= boxes, "{eye:?}: {wrong} of {boxes}");
        // Without faces what overflows is cut, and nothing else is other.
        let cut = scene.draw(&projection, ExtrusionMethod::Raised, Overflow::None, fine());
        let differ = (0..image.len()).filter(|&k| cut[k] != image[k]);
        let (mut count, mut beyond) = (0, 0);
        for k in differ {
            let ray = projection.ray_direction(k as u32 % SIZE[0], k as u32 / SIZE[0]);
            let at = projection.pose.eye - ray * (projection.pose.eye.z / ray.z);
            count += 1;
            beyond += u32::from(
                !(0.0..SQUARE_M).contains(&at.x) || !(0.0..SQUARE_M).contains(&at.y) || ray.z > 0.0,
            );
        }
        assert_eq!(count, beyond, "{eye:?}: pixels of the rectangle itself changed");
    }
}

/// The plane extended shows what the faces show (claims 4 and 5, 7).
#[test]
fn both_overflows_show_the_same() {
    let scene = Scene::a_box();
    for eye in EYES {
        let projection = view(eye);
        let [a, b] = [Overflow::Extended, Overflow::Faces]
            .map(|overflow| scene.draw(&projection, ExtrusionMethod::Raised, overflow, fine()));
        let differ = a.iter().zip(&b).filter(|(a, b)| seen(**a) != seen(**b)).count();
        println!("from {eye:?}: {differ} differ");
        assert!(differ * 500 <= a.len(), "{eye:?}: {differ}");
    }
}

/// A thin wall is missed between coarse slices, and found between fine ones (claim 3).
#[test]
fn more_slices_miss_less() {
    let scene = Scene::a_box();
    let projection = view([-34.0, 2.0, 12.0]);
    let errors = [4, 16, 64, 256].map(|slices| {
        let search = SearchParameters {
            slices,
            ..SearchParameters::default()
        };
        wrong(
            &projection,
            &scene.draw(&projection, ExtrusionMethod::Raised, Overflow::Faces, search),
        )
    });
    println!("wrong pixels by 4, 16, 64, 256 slices: {errors:?}");
    assert!(
        errors.windows(2).all(|pair| pair[1] <= pair[0]) && errors[0] > 4 * errors[3],
        "{errors:?}"
    );
}

/// Halving brings the place that is found to where the ray meets the wall (claim 2): the texture tells how far east it is.
#[test]
fn refinements_place_the_surface() {
    let scene = Scene::a_box();
    let projection = view([-30.0, 9.0, 14.0]);
    let errors = [0, 3, 8].map(|refinements| {
        let search = SearchParameters {
            slices: 32,
            refinements,
            ..SearchParameters::default()
        };
        let image = scene.draw(&projection, ExtrusionMethod::Raised, Overflow::Faces, search);
        let (mut sum, mut count) = (0.0, 0);
        for (k, pixel) in image.iter().enumerate() {
            let ray = projection.ray_direction(k as u32 % SIZE[0], k as u32 / SIZE[0]);
            let (met, t) = truth(projection.pose.eye, ray);
            let at = projection.pose.eye + t * ray;
            // The wall that looks west; shaded, so the channels' ratio counts.
            if met == Met::Box && seen(*pixel) == Met::Box && (at.x - BOX[0]).abs() < 1e-6 {
                let linear = |code: u8| (f64::from(code) / 255.0).powf(2.2);
                let east = (linear(pixel[2]) / linear(pixel[0])).powf(1.0 / 2.2) * SQUARE_M;
                sum += (east - at.x).abs();
                count += 1;
            }
        }
        assert!(count > 300, "{count}");
        sum / f64::from(count)
    });
    println!("mean error by 0, 3, 8 halvings: {errors:?} m");
    assert!(
        errors[0] > 2.0 * errors[1] && errors[1] > errors[2] && errors[2] < 0.2,
        "{errors:?}"
    );
}

/// Walls rise by more than the threshold over the slice above, a ramp does not (claims 9 and 10).
#[test]
fn steep_slopes_take_the_facade() {
    let is_facade =
        |pixel: &&[u8; 4]| pixel[0] > 60 && pixel[1] < 40 && pixel[2] > 60 && pixel[0].abs_diff(pixel[2]) < 6;
    let scene = Scene::a_box();
    let projection = view(EYES[0]);
    let image = scene.draw(&projection, ExtrusionMethod::Facades, Overflow::Faces, fine());
    let (mut wrong, mut walls) = (0, 0);
    for (k, pixel) in image.iter().enumerate() {
        let ray = projection.ray_direction(k as u32 % SIZE[0], k as u32 / SIZE[0]);
        let (met, t) = truth(projection.pose.eye, ray);
        let height = projection.pose.eye.z + t * ray.z;
        if met == Met::Box && height > 0.3 && (height - HEIGHT_M).abs() > 0.3
            || met == Met::Box && (height - HEIGHT_M).abs() < 1e-6
        {
            let is_wall = height < HEIGHT_M - 0.1;
            walls += u32::from(is_wall);
            wrong += u32::from(is_facade(&pixel) != is_wall);
        }
    }
    println!("{wrong} of {walls} walls' pixels wrong");
    assert!(walls > 500 && wrong * 50 <= walls, "{wrong} of {walls}");
    let ramp = Scene::new(|[x, _]| x / SQUARE_M);
    // From the west, where no side of it is seen.
    let image = ramp.draw(
        &view([-20.0, 10.0, 30.0]),
        ExtrusionMethod::Facades,
        Overflow::Faces,
        fine(),
    );
    assert!(image.iter().filter(|pixel| seen(**pixel) != Met::Nothing).count() > 2000);
    assert_eq!(image.iter().filter(is_facade).count(), 0);
}

/// The search over a city against the exact walk: its wrong pixels, by the number of slices, and never none (the patent's method steps
/// over what is thinner than a step).
#[test]
fn search_approaches_the_truth() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let sun = Sun::from_azimuth_altitude(225.0, 42.0);
    for (name, eye, target) in support::VIEWS {
        let camera = support::pinhole(eye, target, 1.0);
        let request = support::request(&camera, &sun, SIZE);
        let exact = renderer.still(&request, 1).unwrap();
        let shares = [16, 64, 256, 1024].map(|slices| {
            let search = SearchParameters {
                slices,
                ..SearchParameters::default()
            };
            let request = FrameRequest {
                relief: ReliefSettings {
                    mode: ReliefMode::Search,
                    search,
                    ..ReliefSettings::default()
                },
                ..request
            };
            let found = renderer.still(&request, 1).unwrap();
            let either = exact
                .ids
                .iter()
                .zip(&found.ids)
                .filter(|(a, b)| **a > 0 || **b > 0);
            let differ = either.clone().filter(|(a, b)| a != b).count();
            differ as f64 / either.count() as f64
        });
        println!("{name}: wrong by 16, 64, 256, 1024 slices: {shares:.3?}");
        assert!(
            shares[0] >= shares[1] && shares[1] >= shares[2],
            "{name}: {shares:?}"
        );
        // Texels of a metre are what is left.
        assert!(shares[3] < 0.12, "{name}: {shares:?}");
    }
}

/// The patent's figures look as they did when they were looked at: `tests/fixtures/figures.png`, drawn by
/// `rilievo relief --figures --size 100x80`.
#[test]
fn figures_look_as_they_did() {
    const FIGURE: [u32; 2] = [100, 80];
    const COLUMNS: u32 = 4;
    const GAP: u32 = 6;
    let golden = image::open("tests/fixtures/figures.png").unwrap().into_rgba8();
    let gpu = Gpu::open().unwrap();
    for (index, figure) in (0..).zip(&FIGURES) {
        let drawn = draw_figure(&gpu, figure, FIGURE).unwrap();
        let [left, top] = [
            index % COLUMNS * (FIGURE[0] + GAP),
            index / COLUMNS * (FIGURE[1] + GAP),
        ];
        let others = drawn.chunks_exact(4).zip(0..).filter(|(pixel, k)| {
            let known = golden.get_pixel(left + k % FIGURE[0], top + k / FIGURE[0]);
            known.0.iter().zip(*pixel).any(|(a, b)| a.abs_diff(*b) > 12)
        });
        // Devices round the place of an edge differently.
        let others = others.count();
        println!("figure {}: {others} pixels differ", figure.name);
        assert!(others < 40, "figure {}: {others} pixels", figure.name);
    }
}
