//! Claims of the two patents that no other test holds: KR 10-1465658 (9 and 19, 12 and 22) and KR 10-1658883 (5 and 18, 10, 11).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use glam::DVec2;
use rilievo::camera::flare::{
    Aperture, FlareImage, FlareImager, FlareLight, FlareMode, FlareParameters, FlareRequest, FlareSource,
    FlareTable, GhostParameters, GhostTable, ImageKnots, ImageTable, LightImage, Quality, Tracing,
    bake_images, flare_mesh, open_table, table_from_photos, write_table,
};
use rilievo::camera::lens::{D_LINE_UM, Lens, built_in};
use rilievo::camera::{Ghost, Paraxial, single_crossing_ghosts, srgb};
use rilievo::gpu::Gpu;
use rilievo::output::write_png;

const SIZE: [u32; 2] = [240, 240];
const CIRCLE: Aperture = Aperture {
    blades: 0,
    rounding: 0.0,
    rotation: 0.0,
    dirt: 0,
};

fn lens(name: &str) -> Arc<Lens> {
    Arc::new(built_in(name).unwrap().unwrap())
}

fn ghosts(mode: FlareMode, only: Option<Ghost>) -> GhostParameters {
    GhostParameters {
        mode,
        only,
        ..Quality::Medium.preset().ghosts()
    }
}

/// A square part of the sensor, a point of light.
fn request(lens: &Arc<Lens>, ghosts: GhostParameters, aperture: Aperture, half_mm: f64) -> FlareRequest {
    FlareRequest {
        lens: Arc::clone(lens),
        f_number: 8.0,
        aperture,
        ghosts: Some(ghosts),
        starburst: None,
        table: None,
        light: FlareLight::point(0.0, 0.0),
        image_half_mm: [half_mm; 2],
    }
}

fn light_of(image: &FlareImage) -> f64 {
    image.radiance.iter().map(|rgb| f64::from(rgb[1])).sum()
}

/// KR 10-1465658, claims 9 and 19: the ray through the centre of the area where light comes in and the one farthest from it tell a ghost's
/// place and size.
#[test]
fn the_centre_and_the_farthest_ray_place_a_ghost() {
    let lens = lens("angenieux");
    let (angle, f_number) = (0.05, 8.0);
    let d_line = Paraxial::new(&lens, D_LINE_UM, None);
    let stop_mm = d_line.stop_radius(f_number);
    let paraxial = Paraxial::new(&lens, 0.51, Some(d_line.sensor_gap_mm()));
    let mut checked = 0;
    for ghost in single_crossing_ghosts(&lens) {
        let matrices = paraxial.matrices(Some(ghost));
        let [a0, a1, f0, f1] = [
            matrices.ma.x_axis.x,
            matrices.ma.y_axis.x,
            matrices.mf.x_axis.x,
            matrices.mf.y_axis.x,
        ];
        let (slope, pupil_mm) = (f64::tan(angle), stop_mm / a0.abs());
        let centre_mm = -a1 / a0 * slope;
        // Pupils that the front does not cut.
        if centre_mm.abs() + pupil_mm > lens.clear_radius(0) {
            continue;
        }
        let mesh = flare_mesh(&FlareParameters {
            lens: &lens,
            source: FlareSource {
                angle,
                azimuth: 0.0,
                f_number,
                angular_radius: 0.0,
            },
            ghosts: ghosts(FlareMode::TwoRays, Some(ghost)),
            table: None,
            tracing: Tracing::Cpu,
        })
        .unwrap();
        let green: Vec<DVec2> = mesh
            .added
            .iter()
            .filter(|vertex| vertex.radiance[1] > 0.0)
            .map(|vertex| glam::Vec2::from_array(vertex.sensor_mm).as_dvec2())
            .collect();
        let (min, max) = green
            .iter()
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), at| {
                (min.min(*at), max.max(*at))
            });
        // By hand: x = Mf11 r + Mf12 tan a at the pupil's centre, and half the size Mf11 times the pupil's radius.
        let place = DVec2::new(f0 * centre_mm + f1 * slope, 0.0);
        let radius = f0.abs() * pupil_mm;
        assert!(
            (0.5 * (min + max)).distance(place) < 1e-3 * (1.0 + place.length()),
            "{ghost:?}"
        );
        let half = 0.5 * (max - min);
        assert!(
            (half - radius).abs().max_element() < 1e-3 * (1.0 + radius),
            "{ghost:?}: {half} and {radius}"
        );
        checked += 1;
    }
    assert!(checked > 15, "only {checked}");
}

/// KR 10-1465658, claims 12 and 22: a ghost has the iris's shape, upside down where its image is, and the iris's part of a round one's light.
#[test]
fn a_ghost_has_the_shape_of_the_iris() {
    let gpu = Gpu::open().unwrap();
    let mut imager = FlareImager::new(&gpu);
    let lens = lens("angenieux");
    let d_line = Paraxial::new(&lens, D_LINE_UM, None);
    let paraxial = Paraxial::new(&lens, 0.51, Some(d_line.sensor_gap_mm()));
    let iris = Aperture {
        blades: 5,
        rounding: 0.0,
        rotation: 0.3,
        dirt: 0,
    };
    let mut checked = [0, 0];
    for ghost in single_crossing_ghosts(&lens) {
        let matrices = paraxial.matrices(Some(ghost));
        let pupil_mm = d_line.stop_radius(8.0) / matrices.ma.x_axis.x.abs();
        let radius_mm = matrices.mf.x_axis.x.abs() * pupil_mm;
        if pupil_mm > lens.clear_radius(0) || !(2.0..20.0).contains(&radius_mm) {
            continue;
        }
        let half_mm = 1.3 * radius_mm;
        let mut drawn = |aperture| {
            let request = request(&lens, ghosts(FlareMode::Paraxial, Some(ghost)), aperture, half_mm);
            imager.draw(&request, SIZE).unwrap()
        };
        let (round, blades) = (drawn(CIRCLE), drawn(iris));
        let part = light_of(&blades) / light_of(&round);
        let expected = 5.0 / TAU * (TAU / 5.0).sin();
        assert!(
            (part / expected - 1.0).abs() < 0.02,
            "{ghost:?}: {part} and {expected}"
        );
        // Upside down where the sensor's image of the stop is.
        let sign = -(matrices.mf.x_axis.x / matrices.ma.x_axis.x).signum();
        let level = 0.5 * blades.radiance[120 * 240 + 120][1];
        for k in 0..40 {
            let direction = DVec2::from_angle(TAU * f64::from(k) / 40.0);
            let is_lit = |r: f64| {
                let at = DVec2::splat(120.0) + r * 120.0 / half_mm * DVec2::new(direction.x, -direction.y);
                blades.radiance[at.y as usize * 240 + at.x as usize][1] > level
            };
            let edge_mm = radius_mm * iris.edge(sign * direction);
            let pixel_mm = 2.0 * half_mm / 240.0;
            assert!(
                is_lit(edge_mm - 2.0 * pixel_mm) && !is_lit(edge_mm + 2.0 * pixel_mm),
                "{ghost:?} {k}"
            );
        }
        checked[usize::from(sign > 0.0)] += 1;
    }
    assert!(checked[0] > 0 && checked[1] > 0, "{checked:?}");
}

/// An image turned by a quarter, by its pixels.
fn quarter(radiance: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let size = SIZE[0] as usize;
    // Rows run downwards: what was right is now on top.
    (0..size * size)
        .map(|k| {
            let (column, row) = (k % size, k / size);
            radiance[column * size + (size - 1 - row)]
        })
        .collect()
}

/// A photo of radiance, exposed for its brightest pixel, RGBA; and that.
fn photo_of(radiance: &[[f32; 3]]) -> (Vec<u8>, f32) {
    let peak = radiance.iter().flatten().fold(0.0_f32, |most, &v| most.max(v));
    let pixel = |rgb: &[f32; 3]| {
        let [r, g, b] = rgb.map(|v| srgb(v / peak));
        [r, g, b, 255]
    };
    (radiance.iter().flat_map(pixel).collect(), peak)
}

/// KR 10-1658883, claims 3 and 16 (patterns out of photos and out of a video of the light's passage), 14 and 20 (traced patterns, of one
/// angle and of two, and photographed ones in one table), 4 and 17 (the choice between them when they are drawn).
#[test]
fn one_table_holds_traced_and_photographed_patterns() {
    let gpu = Gpu::open().unwrap();
    let mut imager = FlareImager::new(&gpu);
    let lens = lens("tessar");
    let folder = tempfile::tempdir().unwrap();
    let half_mm = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
    let base = request(&lens, ghosts(FlareMode::Blended, None), CIRCLE, half_mm);
    // A light that passes from 4 to 8 degrees, a picture at every degree, one a second.
    let mut list = "file,theta_deg\n".to_owned();
    for degrees in 4..=8 {
        let light = FlareLight::point(f64::from(degrees).to_radians(), 0.0);
        let shot = imager
            .draw(
                &FlareRequest {
                    light,
                    ..base.clone()
                },
                SIZE,
            )
            .unwrap();
        let (photo, _) = photo_of(&shot.radiance);
        write_png(&folder.path().join(format!("{degrees}.png")), SIZE, &photo).unwrap();
        list += &format!("{degrees}.png,{degrees}\n");
    }
    let list_file = folder.path().join("list.csv");
    std::fs::write(&list_file, list).unwrap();
    let photos = table_from_photos(&list_file, None, 2.0 * half_mm, 1.0, false).unwrap();
    let video = folder.path().join("passage.mov");
    let encoded = std::process::Command::new("ffmpeg")
        .args([
            "-loglevel",
            "error",
            "-framerate",
            "1",
            "-start_number",
            "4",
            "-i",
        ])
        .arg(folder.path().join("%d.png"))
        .args(["-c:v", "png"])
        .arg(&video)
        .status();
    assert!(encoded.unwrap().success(), "ffmpeg, which films need too");
    let passage = "file,theta_deg,at_s\npassage.mov,4,0\npassage.mov,8,4\n";
    std::fs::write(&list_file, passage).unwrap();
    let filmed = table_from_photos(&list_file, None, 2.0 * half_mm, 1.0, false).unwrap();
    assert_eq!(filmed.len(), 5);
    for degrees in 4..=8 {
        let angle = f64::from(degrees).to_radians();
        let [seen, kept] = [&filmed, &photos].map(|table| {
            let shown = table.evaluate(angle, 0.0);
            let most = shown
                .iter()
                .max_by(|a, b| a.fraction.total_cmp(&b.fraction))
                .unwrap();
            assert!(most.fraction > 0.999_999);
            most.image.radiance()
        });
        let off = seen
            .iter()
            .flatten()
            .zip(kept.iter().flatten())
            .map(|(a, b)| (a - b).abs());
        let most = off.fold(0.0_f32, f32::max);
        println!("{degrees}: {most}");
        assert!(
            seen.len() == kept.len() && most < 0.01,
            "{degrees} degrees: another picture, by {most}"
        );
    }

    let stored = |table: &GhostTable, name: &str| {
        let path = folder.path().join(name);
        write_table(&path, &lens, table.clone()).unwrap();
        let opened = open_table(&path, &lens, 8.0).unwrap();
        assert!(opened == *table, "{name}");
        Arc::new(opened)
    };
    let knots = ImageKnots {
        max_angle: 0.2,
        angles: 3,
        azimuths: 2,
        size: 120,
    };
    for traced in [
        GhostTable::of_rays(FlareTable::bake(&lens, 8.0, 0.4)),
        GhostTable::of_images(bake_images(&mut imager, &base, knots).unwrap()),
    ] {
        let both = stored(&traced.clone().with_photos(Some(filmed.clone())), "both");
        let [traced, photographed] =
            [traced, GhostTable::of_photos(filmed.clone())].map(|table| stored(&table, "one"));
        let mut draw = |table: &Arc<GhostTable>, photographed: bool| {
            let request = FlareRequest {
                table: Some(Arc::clone(table)),
                ghosts: base.ghosts.map(|ghosts| GhostParameters {
                    photographed,
                    ..ghosts
                }),
                light: FlareLight::point(5.6_f64.to_radians(), 0.4),
                ..base.clone()
            };
            imager.draw(&request, SIZE).unwrap().radiance
        };
        let shown = [false, true].map(|choice| draw(&both, choice));
        assert!(shown[0] == draw(&traced, false), "the traced part is another");
        assert!(
            shown[1] == draw(&photographed, false),
            "the photographed part is another"
        );
        assert!(shown[0] != shown[1]);
    }
}

/// KR 10-1658883, claims 10 and 19: photographed patterns are drawn without linear ghosts, unless they are said to show the nonlinear ones
/// alone.
#[test]
fn photographed_patterns_are_drawn_alone() {
    let gpu = Gpu::open().unwrap();
    let mut imager = FlareImager::new(&gpu);
    let lens = lens("nikon");
    let half_mm = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
    let dark =
        |degrees: f64| LightImage::new(degrees.to_radians(), 0.0, &[[0.0; 3]; 4], [2, 2], [half_mm; 2]);
    let mut light_of = |with_linear: bool| {
        let photos = ImageTable::new(vec![dark(0.0), dark(20.0)], with_linear, None);
        let base = request(&lens, ghosts(FlareMode::Blended, None), CIRCLE, half_mm);
        let request = FlareRequest {
            table: Some(Arc::new(GhostTable::of_photos(photos))),
            light: FlareLight::point(0.1, 0.0),
            f_number: 16.0,
            ..base
        };
        let image = imager.draw(&request, SIZE).unwrap();
        image
            .radiance
            .iter()
            .flatten()
            .map(|&v| f64::from(v))
            .sum::<f64>()
    };
    assert_eq!(light_of(false), 0.0);
    assert!(light_of(true) > 0.0);
}

/// KR 10-1658883, claims 5 and 18 (the pattern of an angle, rotated about the axis by the light's azimuth), 10 and 11 (tables of photos, and
/// of images over two angles, out of their files).
#[test]
fn patterns_turn_with_the_light() {
    let gpu = Gpu::open().unwrap();
    let mut imager = FlareImager::new(&gpu);
    let lens = lens("tessar");
    let folder = tempfile::tempdir().unwrap();
    let half_mm = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
    let base = request(&lens, ghosts(FlareMode::Blended, None), CIRCLE, half_mm);
    let at = |azimuth: f64, table: Option<&Arc<GhostTable>>| FlareRequest {
        light: FlareLight::point(0.17, azimuth),
        table: table.cloned(),
        ..base.clone()
    };
    let stored = |table: GhostTable, name: &str| {
        let path = folder.path().join(name);
        write_table(&path, &lens, table.clone()).unwrap();
        let opened = open_table(&path, &lens, 8.0).unwrap();
        assert!(opened == table, "{name}");
        Arc::new(opened)
    };
    let rays = stored(GhostTable::of_rays(FlareTable::bake(&lens, 8.0, 0.4)), "rays");
    let knots = ImageKnots {
        max_angle: 0.34,
        angles: 3,
        azimuths: 4,
        size: 240,
    };
    let images = stored(
        GhostTable::of_images(bake_images(&mut imager, &base, knots).unwrap()),
        "images",
    );
    let shot = imager.draw(&at(0.0, None), SIZE).unwrap();
    let (photo, peak) = photo_of(&shot.radiance);
    write_png(&folder.path().join("a.png"), SIZE, &photo).unwrap();
    let list = folder.path().join("list.csv");
    let degrees = 0.17_f64.to_degrees();
    std::fs::write(
        &list,
        format!(
            "file,theta_deg\na.png,{}\na.png,{}\n",
            degrees - 1.0,
            degrees + 1.0
        ),
    )
    .unwrap();
    let photos = table_from_photos(&list, None, 2.0 * half_mm, peak, false).unwrap();
    let photos = stored(GhostTable::of_photos(photos), "photos");
    for (name, table) in [("rays", &rays), ("images", &images), ("photos", &photos)] {
        let first = imager.draw(&at(0.0, Some(table)), SIZE).unwrap();
        let turned = imager.draw(&at(FRAC_PI_2, Some(table)), SIZE).unwrap();
        let expected = quarter(&first.radiance);
        let off = |a: &[[f32; 3]], b: &[[f32; 3]]| {
            let pairs = a.iter().flatten().zip(b.iter().flatten());
            let sum: f64 = pairs.map(|(a, b)| f64::from((a - b).abs())).sum();
            sum / a.iter().flatten().map(|&v| f64::from(v)).sum::<f64>()
        };
        let (turned_off, still_off) = (off(&expected, &turned.radiance), off(&expected, &first.radiance));
        println!("{name}: {turned_off:.4} off when turned, {still_off:.3} if not");
        assert!(turned_off < 0.04, "{name}: {turned_off}");
        assert!(still_off > 0.2, "{name}: the pattern is round");
        // Half a turn about the axis is a mirror image of the light's side.
        let half = imager.draw(&at(PI, Some(table)), SIZE).unwrap();
        assert!(off(&quarter(&expected), &half.radiance) < 0.04, "{name}");
    }
}
