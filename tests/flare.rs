//! The flare: laws of energy and diffraction, and each way of making ghosts against dense exact rays.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec2;
use num_complex::Complex64;
use rilievo::camera::flare::{
    Aperture, Blend, CacheFills, Diffraction, Fit, FlareEffect, FlareImage, FlareImager, FlareLight,
    FlareMode, FlareParameters, FlareRequest, FlareSource, FlareTable, GhostParameters, GhostTable,
    ImageKnots, Quality, StarburstParameters, Tracing, bake_images, fft_2d, film_half_mm, flare_mesh,
    open_table, spectrum, table_from_photos, write_table,
};
use rilievo::camera::lens::{D_LINE_UM, Lens, built_in};
use rilievo::camera::{
    Paraxial, START_COMPRESSION, Tracer, auto_exposure, beam_direction, shoulder, single_crossing_ghosts,
    srgb, tone_curve, tone_mapped,
};
use rilievo::gpu::{Gpu, Target, read_buffer, read_texture};
use rilievo::output::write_png;
use rilievo::space::SOLAR_ANGULAR_RADIUS;

const CIRCLE: Aperture = Aperture {
    blades: 0,
    rounding: 0.0,
    rotation: 0.0,
    dirt: 0,
};

#[test]
fn the_transform_is_the_direct_sum_and_keeps_energy() {
    let side = 16;
    let field: Vec<Complex64> = (0..side * side)
        .map(|k| Complex64::new((k as f64 * 0.71).sin(), (k as f64 * 1.37).cos()))
        .collect();
    let mut fast = field.clone();
    fft_2d(side, &mut fast);
    let scale = fast.iter().map(|value| value.norm()).fold(0.0, f64::max);
    for (row, column) in [(0, 0), (1, 0), (3, 5), (15, 8), (7, 15)] {
        let direct: Complex64 = (0..side * side)
            .map(|k| {
                let phase = -TAU * ((k % side) * column + (k / side) * row) as f64 / side as f64;
                field[k] * Complex64::from_polar(1.0, phase)
            })
            .sum();
        assert!((fast[row * side + column] - direct).norm() < 1e-5 * scale);
    }
    let energy = |values: &[Complex64]| values.iter().map(Complex64::norm_sqr).sum::<f64>();
    let ratio = energy(&fast) / (energy(&field) * (side * side) as f64);
    assert!((ratio - 1.0).abs() < 1e-4, "Parseval: {ratio}");
}

/// First zero at 1.22 λ N (Airy 1835), for two wavelengths: its radius scales with the wavelength.
#[test]
fn a_round_opening_gives_airys_pattern() {
    let diffraction = Diffraction::from_aperture(&CIRCLE, 1024, 12.0);
    let centre = 512 * 1024 + 512;
    let least = (8..22)
        .min_by(|&a, &b| diffraction.power[centre + a].total_cmp(&diffraction.power[centre + b]))
        .unwrap();
    // The amplitude goes through zero linearly: place it between the bins by its signed root.
    let root = |k: usize| diffraction.power[centre + k].sqrt();
    let (below, above) = (root(least - 1), root(least + 1));
    let zero = least as f64 - 1.0 + 2.0 * below / (below + above);
    for wavelength_um in [0.45, 0.65] {
        let radius_mm = zero * diffraction.bin_mm(wavelength_um, 8.0);
        let airy_mm = 1.219_67 * wavelength_um * 1e-3 * 8.0;
        assert!(
            (radius_mm / airy_mm - 1.0).abs() < 0.01,
            "{radius_mm} and {airy_mm} mm"
        );
    }
}

/// Even numbers of blades give as many spikes, odd ones twice as many.
#[test]
fn spikes_by_blades() {
    for (blades, spikes) in [(5, 10), (6, 6), (7, 14), (8, 8), (9, 18)] {
        let aperture = Aperture {
            blades,
            rotation: 0.1,
            ..CIRCLE
        };
        let side = 1024;
        let diffraction = Diffraction::from_aperture(&aperture, side, 2.0);
        // Power by direction, rings 40 to 250 bins from the centre, each weighted by its radius.
        let sectors = 720;
        let mut power = vec![0.0; sectors];
        for (k, value) in diffraction.power.iter().enumerate() {
            let at = DVec2::new((k % side) as f64, (k / side) as f64) - (side / 2) as f64;
            if (40.0..250.0).contains(&at.length()) {
                let sector = (at.y.atan2(at.x).rem_euclid(TAU) / TAU * sectors as f64) as usize % sectors;
                power[sector] += value * at.length();
            }
        }
        let power: Vec<f64> = (0..sectors)
            .map(|k| (0..9).map(|d| power[(k + sectors + d - 4) % sectors]).sum())
            .collect();
        let most = power.iter().copied().fold(0.0, f64::max);
        let high: Vec<bool> = power.iter().map(|&value| value > 0.3 * most).collect();
        let rises = (0..sectors)
            .filter(|&k| high[k] && !high[(k + sectors - 1) % sectors])
            .count();
        assert_eq!(rises, spikes, "{blades} blades");
    }
}

const SIZE: [u32; 2] = [240, 160];

fn lens(name: &str) -> Arc<Lens> {
    Arc::new(built_in(name).unwrap().unwrap())
}

fn ghosts(mode: FlareMode, rays: usize) -> GhostParameters {
    GhostParameters {
        mode,
        rays,
        ..Quality::Medium.preset().ghosts()
    }
}

/// Ghosts alone of a point of light at an angle in degrees.
fn request(lens: &Arc<Lens>, angle_deg: f64, f_number: f64, ghosts: GhostParameters) -> FlareRequest {
    FlareRequest {
        lens: Arc::clone(lens),
        f_number,
        aperture: Aperture::default(),
        ghosts: Some(ghosts),
        starburst: None,
        table: None,
        light: FlareLight::point(angle_deg.to_radians(), 0.5),
        image_half_mm: film_half_mm(lens, SIZE),
    }
}

fn draw(gpu: &Gpu, request: &FlareRequest) -> FlareImage {
    FlareImager::new(gpu).draw(request, SIZE).unwrap()
}

/// How near two flares come in 8 bits at the exposure of the first, dB.
fn nearness(reference: &FlareImage, tested: &FlareImage) -> f64 {
    let exposure = auto_exposure(&reference.radiance);
    psnr(
        &tone_mapped(&reference.radiance, exposure),
        &tone_mapped(&tested.radiance, exposure),
    )
}

/// Peak signal-to-noise ratio of two 8-bit pictures, dB.
fn psnr(a: &[u8], b: &[u8]) -> f64 {
    let square: f64 = a
        .iter()
        .zip(b)
        .map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2))
        .sum();
    // Three of four channels count; the fourth is the same.
    20.0 * 255_f64.log10() - 10.0 * (square / (0.75 * a.len() as f64)).max(1e-9).log10()
}

#[test]
fn each_mode_comes_near_dense_exact_rays() {
    let gpu = Gpu::open().unwrap();
    for (name, angle, f_number, mode, least) in [
        ("heliar", 5.0, 22.0, FlareMode::Paraxial, 35.0),
        ("heliar", 5.0, 22.0, FlareMode::Blended, 44.0),
        ("tessar", 12.0, 8.0, FlareMode::Blended, 44.0),
        ("angenieux", 5.0, 8.0, FlareMode::Blended, 44.0),
    ] {
        let lens = lens(name);
        let drawn = |mode, rays| draw(&gpu, &request(&lens, angle, f_number, ghosts(mode, rays)));
        let (dense, tested) = (drawn(FlareMode::Exact, 100), drawn(mode, 24));
        let near = nearness(&dense, &tested);
        println!("{name} {mode:?}: {near:.2} dB");
        assert!(near > least, "{name} {mode:?}: {near} dB");
    }
}

/// The table gives back what exact rays give, also between its angles and colours, and out of its file (KR 10-1658883 states
/// 26.91 dB).
#[test]
fn the_table_comes_near_dense_exact_rays() {
    let gpu = Gpu::open().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut all = Vec::new();
    for name in ["heliar", "tessar", "angenieux"] {
        let lens = lens(name);
        let path = folder.path().join(name);
        let baked = GhostTable::of_rays(FlareTable::bake(&lens, 8.0, 0.4));
        let bytes = write_table(&path, &lens, baked.clone()).unwrap();
        assert!(bytes < 4_000_000, "{name}: {bytes} bytes");
        let opened = open_table(&path, &lens, 8.0).unwrap();
        assert!(opened == baked);
        assert!(open_table(&path, &lens, 5.6).is_err(), "another f-number");
        let table = Arc::new(opened);
        for angle in [1.0, 6.0, 13.0] {
            let drawn = |mode, rays, table| {
                let request = request(&lens, angle, 8.0, ghosts(mode, rays));
                draw(&gpu, &FlareRequest { table, ..request })
            };
            let dense = drawn(FlareMode::Exact, 80, None);
            let evaluated = drawn(FlareMode::Blended, 36, Some(Arc::clone(&table)));
            all.push(nearness(&dense, &evaluated));
        }
    }
    println!("{all:.2?} dB");
    assert!(all.iter().sum::<f64>() / all.len() as f64 > 36.0, "{all:?}");
    assert!(all.iter().all(|&near| near > 32.0), "{all:?}");
}

#[test]
fn damaged_tables_and_other_lenses_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.flare");
    let table = GhostTable::of_rays(FlareTable::bake(&lens("tessar"), 8.0, 0.3));
    write_table(&path, &lens("tessar"), table).unwrap();
    let refusal = |path: &std::path::Path, name| open_table(path, &lens(name), 8.0).unwrap_err().to_string();
    assert!(refusal(&path, "heliar").contains("another lens"));
    let bytes = std::fs::read(&path).unwrap();
    for (what, damaged) in [
        ("cut", bytes[..bytes.len() / 2].to_vec()),
        ("text", b"no table".to_vec()),
        (
            "flipped",
            bytes
                .iter()
                .enumerate()
                .map(|(k, b)| if k == bytes.len() / 3 { !b } else { *b })
                .collect(),
        ),
    ] {
        let path = folder.path().join(what);
        std::fs::write(&path, damaged).unwrap();
        assert!(refusal(&path, "tessar").contains("is no flare table"), "{what}");
    }
}

/// Two rays tell the same sprite as four entrance points, as the linear image is similar to the entrance.
#[test]
fn two_rays_draw_what_four_do() {
    let gpu = Gpu::open().unwrap();
    for name in ["heliar", "angenieux", "nikon"] {
        let lens = lens(name);
        let [four, two] = [FlareMode::Paraxial, FlareMode::TwoRays]
            .map(|mode| draw(&gpu, &request(&lens, 4.0, 11.0, ghosts(mode, 2))));
        let exposure = auto_exposure(&four.radiance);
        let (a, b) = (
            tone_mapped(&four.radiance, exposure),
            tone_mapped(&two.radiance, exposure),
        );
        let differing = a.iter().zip(&b).filter(|(a, b)| a.abs_diff(**b) > 1).count();
        assert!(differing * 500 < a.len(), "{name}: {differing} values differ");
    }
}

/// Interpolated, a ghost's light changes little from angle to angle where added it changes at once; with alpha the sum of a
/// linear and an opaque nonlinear image is the nonlinear one alone.
#[test]
fn blends_pass_from_linear_to_nonlinear() {
    let gpu = Gpu::open().unwrap();
    let mut imager = FlareImager::new(&gpu);
    let lens = lens("angenieux");
    let light_of = |picture: &FlareImage| {
        picture
            .radiance
            .iter()
            .flatten()
            .map(|&v| f64::from(v))
            .sum::<f64>()
    };
    let angle = 8_f64.to_radians();
    let mut with = |mode, blend, only| {
        let ghosts = GhostParameters {
            blend,
            only,
            ..ghosts(mode, 24)
        };
        imager.draw(&request(&lens, 8.0, 8.0, ghosts), SIZE).unwrap()
    };
    let mut between = 0;
    for ghost in single_crossing_ghosts(&lens) {
        let Some(nonlinearity_error) = rilievo::camera::flare::nonlinearity(&lens, ghost, angle, 8.0) else {
            continue;
        };
        let [linear, nonlinear] = [FlareMode::Paraxial, FlareMode::Exact]
            .map(|mode| light_of(&with(mode, Blend::Add, Some(ghost))));
        let interpolated = light_of(&with(FlareMode::Blended, Blend::Interpolate, Some(ghost)));
        let (low, high) = (linear.min(nonlinear), linear.max(nonlinear));
        assert!(
            interpolated > 0.98 * low - 1e-6 && interpolated < 1.02 * high + 1e-6,
            "{ghost:?}: {interpolated} between {linear} and {nonlinear}"
        );
        if nonlinearity_error > 0.01 {
            let laid_over = with(FlareMode::Blended, Blend::Alpha, Some(ghost));
            let alone = with(FlareMode::Exact, Blend::Add, Some(ghost));
            // Where the nonlinear image covers, it is all that is seen; beside it the linear one stays.
            let covered = alone.radiance.iter().zip(&laid_over.radiance);
            let off = covered
                .filter(|(alone, _)| alone[1] > 0.0)
                .filter(|(alone, over)| (over[1] / alone[1] - 1.0).abs() > 0.1)
                .count();
            let lit = alone.radiance.iter().filter(|rgb| rgb[1] > 0.0).count();
            println!("{ghost:?}: {off} of {lit} pixels off");
            assert!(off * 8 <= lit, "{ghost:?}: {off} of {lit}");
        } else if nonlinearity_error > 0.002 {
            between += 1;
        }
    }
    assert!(between > 0, "no ghost is between linear and nonlinear");
}

/// Fitted ghosts have their linear image's spread and light.
#[test]
fn nonlinear_ghosts_can_be_fitted_to_linear_ones() {
    let lens = lens("heliar");
    let lit = FlareSource {
        angle: 8_f64.to_radians(),
        azimuth: 0.5,
        f_number: 8.0,
        angular_radius: 0.0,
    };
    // Light, and its root mean square distance from its centre, over all triangles of the green channel.
    let moments = |mode, fit, ghost| {
        let mesh = flare_mesh(&FlareParameters {
            lens: &lens,
            source: lit,
            ghosts: GhostParameters {
                fit,
                only: Some(ghost),
                ..ghosts(mode, 40)
            },
            table: None,
            tracing: Tracing::Cpu,
        })
        .unwrap();
        let (mut light, mut first, mut second) = (0.0, DVec2::ZERO, 0.0);
        for triangle in mesh
            .added
            .chunks_exact(3)
            .filter(|corners| corners[0].radiance[1] > 0.0)
        {
            let at = [0, 1, 2].map(|k: usize| glam::Vec2::from_array(triangle[k].sensor_mm).as_dvec2());
            let inside = triangle
                .iter()
                .all(|corner| glam::Vec2::from_array(corner.stop).length() <= 1.0 && corner.barrel[0] <= 1.0);
            if inside {
                let area = 0.5 * (at[1] - at[0]).perp_dot(at[2] - at[0]).abs();
                let share = area * f64::from(triangle[0].radiance[1]);
                let centre = (at[0] + at[1] + at[2]) / 3.0;
                light += share;
                first += share * centre;
                second += share * centre.length_squared();
            }
        }
        let centre = first / light;
        (light, (second / light - centre.length_squared()).sqrt())
    };
    let gap = Paraxial::new(&lens, D_LINE_UM, None).sensor_gap_mm();
    let paraxial = Paraxial::new(&lens, 0.51, Some(gap));
    let mut fitted_ghosts = 0;
    for ghost in single_crossing_ghosts(&lens) {
        let both = Fit {
            size: true,
            brightness: true,
        };
        let (plain_light, plain_spread) = moments(FlareMode::Exact, Fit::default(), ghost);
        let (light, spread) = moments(FlareMode::Exact, both, ghost);
        // A uniform disc of radius R has the root mean square distance R / √2.
        let stop_mm = paraxial.stop_radius(8.0);
        let matrices = paraxial.matrices(Some(ghost));
        let pupil_mm = stop_mm / matrices.ma.x_axis.x.abs();
        let ideal = pupil_mm * matrices.mf.x_axis.x.abs() / 2_f64.sqrt();
        let (off, fitted_off) = ((plain_spread / ideal - 1.0).abs(), (spread / ideal - 1.0).abs());
        // Ghosts that the barrel cuts have no disc to be fitted to.
        if pupil_mm < 6.0 && plain_light > 0.0 {
            assert!(
                fitted_off < 0.06,
                "{ghost:?}: {spread} mm, ideal {ideal} mm, before {plain_spread} mm"
            );
            // What the pupil lets in, less what the ray through its centre loses: irradiance 1 on its area, times 4 N² / π.
            let pupil_middle = -matrices.ma.y_axis.x / matrices.ma.x_axis.x * lit.angle.tan();
            let tracer = Tracer::new(&lens, 0.51, gap);
            let centre = tracer.trace(
                Some(ghost),
                DVec2::new(pupil_middle, 0.0),
                beam_direction(lit.angle),
            );
            let expected = centre.unwrap().power * 4.0 * (8.0 * pupil_mm).powi(2);
            println!(
                "{ghost:?}: light {:.3} of its linear image's, before {:.3}",
                light / expected,
                plain_light / expected
            );
            assert!(
                (light / expected - 1.0).abs() < 0.12,
                "{ghost:?}: {light} of {expected}"
            );
            fitted_ghosts += usize::from(off > fitted_off);
        }
    }
    assert!(fitted_ghosts > 0);
}

/// Images over two angles give back what was baked there; photos too, and half way between two of them half of each.
#[test]
fn tables_of_images_give_what_was_recorded() {
    let gpu = Gpu::open().unwrap();
    let mut imager = FlareImager::new(&gpu);
    let lens = lens("tessar");
    let base = request(&lens, 0.0, 8.0, ghosts(FlareMode::Blended, 24));
    let at = |angle: f64, azimuth: f64, table: Option<&Arc<GhostTable>>| FlareRequest {
        light: FlareLight::point(angle, azimuth),
        table: table.cloned(),
        ..base.clone()
    };
    let knots = ImageKnots {
        max_angle: 0.3,
        angles: 4,
        azimuths: 4,
        size: 288,
    };
    let table = bake_images(&mut imager, &base, knots).unwrap();
    assert_eq!(table.len(), 16);
    let table = Arc::new(GhostTable::of_images(table));
    let (angle, azimuth) = (0.2, TAU / 4.0);
    let whole = imager.draw(&at(angle, azimuth, None), SIZE).unwrap();
    let evaluated = imager.draw(&at(angle, azimuth, Some(&table)), SIZE).unwrap();
    let near = nearness(&whole, &evaluated);
    println!("images: {near:.2} dB");
    assert!(near > 44.0, "{near} dB");

    // The same through photos: sRGB files and a list.
    let folder = tempfile::tempdir().unwrap();
    let mut list = "file,theta_deg\n".to_owned();
    let mut shots = Vec::new();
    for degrees in [6.0_f64, 10.0] {
        let image = imager.draw(&at(degrees.to_radians(), 0.0, None), SIZE).unwrap();
        let exposure = 0.5
            / image
                .radiance
                .iter()
                .flatten()
                .fold(0.0_f32, |most, &v| most.max(v));
        let name = format!("{degrees}.png");
        let photo: Vec<u8> = image
            .radiance
            .iter()
            .flat_map(|&[r, g, b]| [srgb(r * exposure), srgb(g * exposure), srgb(b * exposure), 255])
            .collect();
        write_png(&folder.path().join(&name), SIZE, &photo).unwrap();
        list += &format!("{name},{degrees}\n");
        shots.push(
            image
                .radiance
                .iter()
                .map(|rgb| rgb.map(|v| v * exposure))
                .collect::<Vec<_>>(),
        );
    }
    let path = folder.path().join("list.csv");
    std::fs::write(&path, list).unwrap();
    let photos = table_from_photos(&path, None, lens.film_mm[0], 1.0, false).unwrap();
    let photos = Arc::new(GhostTable::of_photos(photos));
    let mut evaluate = |degrees: f64| {
        let request = at(degrees.to_radians(), 0.0, Some(&photos));
        imager.draw(&request, SIZE).unwrap().radiance
    };
    let worst = |a: &[[f32; 3]], b: &[[f32; 3]]| {
        let pairs = a.iter().flatten().zip(b.iter().flatten());
        let mut off: Vec<f32> = pairs.map(|(a, b)| (a - b).abs()).collect();
        off.sort_by(f32::total_cmp);
        off[off.len() * 995 / 1000]
    };
    assert!(worst(&evaluate(6.0), &shots[0]) < 0.01);
    let half: Vec<[f32; 3]> = shots[0]
        .iter()
        .zip(&shots[1])
        .map(|(a, b)| [0, 1, 2].map(|k: usize| 0.5 * (a[k] + b[k])))
        .collect();
    assert!(worst(&evaluate(8.0), &half) < 0.01);
    assert!(
        evaluate(12.0).iter().flatten().all(|&value| value == 0.0),
        "beyond the table"
    );
}

/// The light of a ghost that lies on the film is what the pupil lets in, less what is lost at the surfaces.
#[test]
fn a_ghost_keeps_its_light() {
    let gpu = Gpu::open().unwrap();
    let lens = lens("angenieux");
    let f_number = 8.0;
    // The iris is set for the d line; the green channel is checked.
    let d_line = Paraxial::new(&lens, D_LINE_UM, None);
    let stop_mm = d_line.stop_radius(f_number);
    let paraxial = Paraxial::new(&lens, 0.51, Some(d_line.sensor_gap_mm()));
    let tracer = Tracer::new(&lens, 0.51, d_line.sensor_gap_mm());
    let mut checked = 0;
    for ghost in single_crossing_ghosts(&lens) {
        let matrices = paraxial.matrices(Some(ghost));
        let pupil_mm = stop_mm / matrices.ma.x_axis.x.abs();
        let size_mm = pupil_mm * matrices.mf.x_axis.x.abs();
        // Those that lie whole on the film, are more than a few pixels wide, and no barrel cuts.
        if !(1.5..8.0).contains(&size_mm) || pupil_mm > 8.0 {
            continue;
        }
        let power = tracer
            .trace(Some(ghost), DVec2::ZERO, beam_direction(0.0))
            .unwrap()
            .power;
        // The exact pupil is no circle and its losses vary: rays counted one by one over the entrance.
        let side = 400;
        let reach = 2.0 * pupil_mm;
        let step = 2.0 * reach / f64::from(side);
        let counted: f64 = (0..side * side)
            .filter_map(|k| {
                let entry = DVec2::new(f64::from(k % side) + 0.5, f64::from(k / side) + 0.5) * step - reach;
                let ray = tracer.trace(Some(ghost), entry, beam_direction(0.0))?;
                let passes = ray.stop_mm.length() <= stop_mm && ray.relative_height <= 1.0;
                passes.then_some(ray.power * step * step)
            })
            .sum();
        for (mode, entrance) in [
            (FlareMode::Paraxial, power * PI * pupil_mm * pupil_mm),
            (FlareMode::Exact, counted),
        ] {
            let expected = entrance * 4.0 * f_number * f_number / PI;
            let only = GhostParameters {
                only: Some(ghost),
                ..ghosts(mode, 96)
            };
            let request = FlareRequest {
                aperture: CIRCLE,
                ..request(&lens, 0.0, f_number, only)
            };
            let picture = draw(&gpu, &request);
            let pixel_mm2 = (36.0 / f64::from(SIZE[0])).powi(2);
            let sum: f64 = picture.radiance.iter().map(|rgb| f64::from(rgb[1])).sum::<f64>() * pixel_mm2;
            assert!(
                (sum / expected - 1.0).abs() < 0.03,
                "{ghost:?} {mode:?}: {sum} of {expected}"
            );
        }
        checked += 1;
    }
    assert!(checked >= 3, "only {checked} ghosts fit");
}

/// The effective pupil draws the same picture by less work (KR 10-1465658).
#[test]
fn the_effective_pupil_changes_nothing_but_the_work() {
    let gpu = Gpu::open().unwrap();
    for name in ["heliar", "angenieux", "nikon"] {
        let lens = lens(name);
        let [clipped, whole] = [false, true].map(|whole_entrance| {
            let ghosts = GhostParameters {
                whole_entrance,
                ..ghosts(FlareMode::Paraxial, 2)
            };
            draw(&gpu, &request(&lens, 3.0, 11.0, ghosts))
        });
        let exposure = auto_exposure(&whole.radiance);
        let (a, b) = (
            tone_mapped(&clipped.radiance, exposure),
            tone_mapped(&whole.radiance, exposure),
        );
        let differing = a.iter().zip(&b).filter(|(a, b)| a.abs_diff(**b) > 1).count();
        println!(
            "{name}: {:.1} times the work without",
            whole.mesh.area_mm2 / clipped.mesh.area_mm2
        );
        assert!(
            differing * 500 < a.len(),
            "{name}: {differing} values differ by more than 1/255"
        );
        assert!(whole.mesh.area_mm2 > 1.5 * clipped.mesh.area_mm2);
    }
}

#[test]
fn a_spectrum_adds_up_to_white() {
    for count in [3, 7, 15, 31] {
        for channel in 0..3 {
            let sum: f64 = spectrum(count).iter().map(|one| one.rgb[channel]).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}

/// Only what changed is made anew: a half hidden sun costs no mesh, a moved one no starburst, and a still one nothing at all.
#[test]
fn a_flare_is_made_once() {
    let gpu = Gpu::open().unwrap();
    let format = wgpu::TextureFormat::Rgba16Float;
    let mut effect = FlareEffect::new(&gpu, format);
    let lens = lens("tessar");
    let still = FlareRequest {
        starburst: Some(StarburstParameters {
            wavelengths: 3,
            transform_size: 256,
            with_disc: true,
        }),
        light: FlareLight {
            angular_radius: SOLAR_ANGULAR_RADIUS,
            ..FlareLight::point(0.1, 0.5)
        },
        ..request(&lens, 0.0, 8.0, ghosts(FlareMode::Blended, 8))
    };
    let of = |light: FlareLight| FlareRequest {
        light,
        ..still.clone()
    };
    let half_hidden = of(FlareLight {
        visible_fraction: 0.5,
        ..still.light
    });
    let moved = of(FlareLight {
        angle: 0.11,
        ..still.light
    });
    let hidden = of(FlareLight {
        visible_fraction: 0.0,
        ..still.light
    });
    let behind = of(FlareLight {
        angle: 2.0,
        ..still.light
    });
    let other_iris = FlareRequest {
        aperture: CIRCLE,
        ..moved.clone()
    };
    let all = |masks, meshes, starbursts| CacheFills {
        masks,
        meshes,
        starbursts,
        images: 0,
    };
    let size = [96, 64];
    for (what, request, changes, fills) in [
        ("first", &still, true, all(1, 1, 1)),
        ("still", &still, false, all(1, 1, 1)),
        ("half hidden", &half_hidden, true, all(1, 1, 1)),
        ("moved", &moved, true, all(1, 2, 1)),
        ("hidden", &hidden, true, all(1, 2, 1)),
        ("behind", &behind, false, all(1, 2, 1)),
        ("back", &moved, true, all(1, 2, 1)),
        ("another iris", &other_iris, true, all(2, 2, 2)),
    ] {
        assert_eq!(effect.prepare(&gpu, request, size).unwrap(), changes, "{what}");
        assert_eq!(effect.fills(), fills, "{what}");
    }

    // A cached one draws what a new one draws, to the bit; half of the light is half of the radiance.
    let image = |effect: &FlareEffect| {
        let target = Target::new(&gpu, "flare", size, format);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        effect.encode(&mut encoder, &target, None);
        gpu.queue.submit([encoder.finish()]);
        read_texture::<[half::f16; 4]>(&gpu, &target.texture).unwrap()
    };
    let fresh = |request| {
        let mut effect = FlareEffect::new(&gpu, format);
        effect.prepare(&gpu, request, size).unwrap();
        image(&effect)
    };
    effect.prepare(&gpu, &still, size).unwrap();
    let whole = image(&effect);
    assert!(whole.iter().any(|texel| texel[1].to_f32() > 0.0));
    assert!(whole == fresh(&still), "a mesh over a longer one");
    effect.prepare(&gpu, &half_hidden, size).unwrap();
    let half = image(&effect);
    assert!(half == fresh(&half_hidden));
    let sum = |image: &[[half::f16; 4]]| {
        image
            .iter()
            .map(|texel| f64::from(texel[1].to_f32()))
            .sum::<f64>()
    };
    assert!((sum(&half) / sum(&whole) - 0.5).abs() < 1e-3);
    effect.prepare(&gpu, &behind, size).unwrap();
    assert_eq!(sum(&image(&effect)), 0.0);
}

/// Colours over the whole range that a half float holds, the same ones every time.
fn colours(count: usize) -> Vec<[f32; 3]> {
    // SplitMix64 (Steele, Lea & Flood 2014).
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 24) as f32
    };
    (0..count)
        .map(|_| [0; 3].map(|_| 10_f32.powf(-4.0 + 8.0 * random())))
        .collect()
}

/// Light added to any colour lowers no channel that is shown, so no luminance either; what is below the shoulder is unchanged,
/// and everything is shown below white.
#[test]
fn added_light_darkens_nothing() {
    let all = colours(20_000);
    for pair in all.chunks_exact(2) {
        let below = tone_curve(pair[0]);
        let sum = tone_curve([0, 1, 2].map(|k: usize| pair[0][k] + pair[1][k]));
        for k in 0..3 {
            assert!(
                sum[k] >= below[k] && sum[k] <= 1.0,
                "{pair:?}: {below:?} to {sum:?}"
            );
            assert!(pair[0][k] >= 0.76 || below[k] == pair[0][k]);
        }
    }
    // IEC 61966-2-1: black, the knee, half, white.
    assert_eq!([0.0, 0.003_130_8, 0.5, 1.0].map(srgb), [0, 10, 188, 255]);
}

/// The curve of the shader is that of the CPU.
#[test]
fn the_tone_curve_is_the_same_on_both_sides() {
    let gpu = Gpu::open().unwrap();
    let inputs: Vec<f32> = colours(1024)
        .into_iter()
        .flatten()
        .chain([-1.0, 0.0, 0.759_999, 0.76, 0.760_001, 1.0, 65504.0])
        .collect();
    let text = format!(
        "const START_COMPRESSION = {START_COMPRESSION:?}f;\n{}\n@group(0) @binding(0) var<storage, read_write> values: array<f32>;\n\
         @compute @workgroup_size(64) fn cs(@builtin(global_invocation_id) id: vec3<u32>) {{\n\
         if id.x < arrayLength(&values) {{ values[id.x] = tone_curve(vec3<f32>(values[id.x])).y; }} }}",
        include_str!("../shaders/lib/tone_curve.wgsl")
    );
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let pipeline = gpu
        .device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("cs"),
            compilation_options: Default::default(),
            cache: None,
        });
    let values = wgpu::util::DeviceExt::create_buffer_init(
        &gpu.device,
        &wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(&inputs),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        },
    );
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: values.as_entire_binding(),
        }],
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(inputs.len().div_ceil(64) as u32, 1, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    let shown = read_buffer::<f32>(&gpu, &values).unwrap();
    for (input, shown) in inputs.iter().zip(shown) {
        let expected = shoulder(*input);
        assert!(
            (shown - expected).abs() <= 1e-6,
            "{input}: {shown} and {expected}"
        );
    }
}

/// Every name in the table of claims is that of a function, a type or a test in the sources.
#[test]
fn the_table_of_claims_names_what_exists() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = String::new();
    let mut folders = vec![root.join("src/camera"), root.join("tests")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                sources += &std::fs::read_to_string(path).unwrap();
            }
        }
    }
    let words: std::collections::HashSet<String> = ["fn ", "struct ", "enum ", "trait "]
        .iter()
        .flat_map(|keyword| sources.split(keyword).skip(1))
        .map(|rest| {
            rest.chars()
                .take_while(|&c| c.is_alphanumeric() || c == '_')
                .collect()
        })
        .collect();
    let fields: std::collections::HashSet<&str> = sources
        .lines()
        .filter_map(|line| {
            line.trim()
                .strip_prefix("pub ")?
                .split_once(':')
                .map(|(name, _)| name)
        })
        .collect();
    let table = std::fs::read_to_string(root.join("src/camera/flare/mod.rs")).unwrap();
    let mut checked = 0;
    for row in table.lines().filter(|line| line.starts_with("//! |")).skip(2) {
        // Odd pieces stand between backquotes.
        for name in row.split('`').skip(1).step_by(2) {
            if name.contains('/') {
                assert!(root.join(name).is_file(), "{name}");
                checked += 1;
                continue;
            }
            for word in name
                .split(|c: char| !(c.is_alphanumeric() || c == '_'))
                .filter(|word| !word.is_empty())
            {
                let is_module = sources.contains(&format!("mod {word};"));
                assert!(
                    words.contains(word) || fields.contains(word) || is_module,
                    "{word} of {name} does not exist: {row}"
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 40, "only {checked} names in the table");
    // Every claim that was not deleted has its row.
    let claims = |patent: &str| -> std::collections::BTreeSet<u32> {
        let rows = table
            .lines()
            .filter_map(|row| row.strip_prefix(&format!("//! | {patent} ")));
        rows.flat_map(|row| row.split(" |").next().unwrap_or_default().split(", "))
            .map(|number| number.parse().unwrap())
            .collect()
    };
    let deleted = [4, 8, 14, 18];
    assert_eq!(
        claims("A"),
        (1..=22).filter(|claim| !deleted.contains(claim)).collect()
    );
    assert_eq!(claims("B"), (1..=20).collect());
}
