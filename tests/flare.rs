//! The flare: laws of energy and diffraction, and each way of making ghosts against dense exact rays.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use num_complex::Complex64;
use rilievo::camera::flare::{Aperture, Diffraction, FlareMode, FlareSource, FlareTable, fft_2d, spectrum};
use rilievo::camera::lens::{D_LINE_UM, built_in};
use rilievo::camera::{Ghost, Paraxial, Tracer, beam_direction};
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::{FlarePicture, auto_exposure, developed, flare_picture};
use rilievo::relief::{CpuMap, SUN_RADIUS, sun_visibility};

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
    let diffraction = Diffraction::of(&CIRCLE, 1024, 12.0);
    let middle = 512 * 1024 + 512;
    let least = (8..22)
        .min_by(|&a, &b| diffraction.power[middle + a].total_cmp(&diffraction.power[middle + b]))
        .unwrap();
    // The amplitude goes through zero linearly: place it between the bins by its signed root.
    let root = |k: usize| diffraction.power[middle + k].sqrt();
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
        let diffraction = Diffraction::of(&aperture, side, 2.0);
        // Power by direction, rings 40 to 250 bins from the middle, each weighted by its radius.
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

fn source(angle_deg: f64, f_number: f64, rays: usize) -> FlareSource {
    FlareSource {
        angle: angle_deg.to_radians(),
        turn: 0.5,
        irradiance: [1.0; 3],
        f_number,
        wavelengths: 3,
        rays,
        whole_entrance: false,
    }
}

const SIZE: [u32; 2] = [240, 160];

fn draw(gpu: &Gpu, name: &str, source: &FlareSource, mode: FlareMode, only: Option<Ghost>) -> FlarePicture {
    let lens = built_in(name).unwrap().unwrap();
    flare_picture(gpu, &lens, source, mode, only, None, &Aperture::default(), SIZE).unwrap()
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
        ("heliar", 5.0, 22.0, FlareMode::Paraxial, 33.0),
        ("heliar", 5.0, 22.0, FlareMode::Blended, 38.0),
        ("tessar", 12.0, 8.0, FlareMode::Blended, 38.0),
        ("angenieux", 5.0, 8.0, FlareMode::Blended, 38.0),
    ] {
        let dense = draw(&gpu, name, &source(angle, f_number, 100), FlareMode::Exact, None);
        let tested = draw(&gpu, name, &source(angle, f_number, 24), mode, None);
        let exposure = auto_exposure(&dense.radiance);
        let near = psnr(
            &developed(&dense.radiance, exposure),
            &developed(&tested.radiance, exposure),
        );
        println!("{name} {mode:?}: {near:.2} dB");
        assert!(near > least, "{name} {mode:?}: {near} dB");
    }
}

/// The table plays back what exact rays give, also between its angles and colours (KR 10-1658883 states 26.91 dB).
#[test]
fn the_table_comes_near_dense_exact_rays() {
    let gpu = Gpu::open().unwrap();
    let mut all = Vec::new();
    for name in ["heliar", "tessar", "angenieux"] {
        let lens = built_in(name).unwrap().unwrap();
        let table = FlareTable::bake(&lens, 8.0, 0.4);
        assert!(table.bytes() < 4_000_000, "{name}: {} bytes", table.bytes());
        for angle in [1.0, 6.0, 13.0] {
            let dense = draw(&gpu, name, &source(angle, 8.0, 80), FlareMode::Exact, None);
            let lit = source(angle, 8.0, 36);
            let (mode, iris) = (FlareMode::Blended, Aperture::default());
            let played = flare_picture(&gpu, &lens, &lit, mode, None, Some(&table), &iris, SIZE).unwrap();
            let exposure = auto_exposure(&dense.radiance);
            all.push(psnr(
                &developed(&dense.radiance, exposure),
                &developed(&played.radiance, exposure),
            ));
        }
    }
    println!("{all:.2?} dB");
    assert!(all.iter().sum::<f64>() / all.len() as f64 > 30.0, "{all:?}");
    assert!(all.iter().all(|&near| near > 24.0), "{all:?}");
}

/// The light of a ghost that lies on the film is what the pupil lets in, less what is lost at the surfaces.
#[test]
fn a_ghost_keeps_its_light() {
    let gpu = Gpu::open().unwrap();
    let lens = built_in("angenieux").unwrap().unwrap();
    let f_number = 8.0;
    // The iris is set for the d line; the green channel is checked.
    let d_line = Paraxial::new(&lens, D_LINE_UM, None);
    let stop_mm = d_line.stop_radius(f_number);
    let paraxial = Paraxial::new(&lens, 0.51, Some(d_line.sensor_gap_mm()));
    let tracer = Tracer::new(&lens, 0.51, d_line.sensor_gap_mm());
    let mut checked = 0;
    for ghost in rilievo::camera::single_crossing_ghosts(&lens) {
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
            let lit = source(0.0, f_number, 96);
            let picture = flare_picture(&gpu, &lens, &lit, mode, Some(ghost), None, &CIRCLE, SIZE).unwrap();
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
        let clipped = draw(&gpu, name, &source(3.0, 11.0, 2), FlareMode::Paraxial, None);
        let whole = draw(
            &gpu,
            name,
            &FlareSource {
                whole_entrance: true,
                ..source(3.0, 11.0, 2)
            },
            FlareMode::Paraxial,
            None,
        );
        let exposure = auto_exposure(&whole.radiance);
        let (a, b) = (
            developed(&clipped.radiance, exposure),
            developed(&whole.radiance, exposure),
        );
        let differing = a.iter().zip(&b).filter(|(a, b)| a.abs_diff(**b) > 1).count();
        println!(
            "{name}: {:.1} times the work without",
            whole.area_mm2 / clipped.area_mm2
        );
        assert!(
            differing * 500 < a.len(),
            "{name}: {differing} values differ by more than 1/255"
        );
        assert!(whole.area_mm2 > 1.5 * clipped.area_mm2);
    }
}

/// As the sun rises over a roof its visible share grows monotonically, and never at once.
#[test]
fn the_sun_fades_softly_behind_a_roof() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let map = CpuMap::new(&city, 1000.0);
    let (_, eye, _) = support::VIEWS[0];
    let eye = DVec3::from_array(eye);
    let mut swept = 0;
    for azimuth_deg in [0.0_f64, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0] {
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let share = |altitude: f64| {
            let to_sun = DVec3::new(sin * altitude.cos(), cos * altitude.cos(), altitude.sin());
            sun_visibility(&city, &map, eye, to_sun).unwrap()
        };
        let (mut low, mut high) = (0.0, 1.3);
        if share(low) > 0.0 || share(high) < 1.0 {
            continue;
        }
        while high - low > 1e-4 {
            let middle = 0.5 * (low + high);
            if share(middle) > 0.5 {
                high = middle
            } else {
                low = middle
            }
        }
        // Sixteen frames from just hidden to just free.
        let frames: Vec<f64> = (0..=16)
            .map(|frame| share(low + 1.15 * SUN_RADIUS * (f64::from(frame) / 8.0 - 1.0)))
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

#[test]
fn a_spectrum_adds_up_to_white() {
    for count in [3, 7, 15, 31] {
        for channel in 0..3 {
            let sum: f64 = spectrum(count).iter().map(|one| one.rgb[channel]).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}
