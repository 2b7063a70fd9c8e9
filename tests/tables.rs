//! Tables against dense exact rays, between their knots, of lenses that none of their parameters were chosen for.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use rilievo::camera::flare::{
    Aperture, FlareImager, FlareLight, FlareMode, FlareRequest, FlareTable, GhostParameters, GhostTable,
    Quality, film_half_mm, open_table, write_table,
};
use rilievo::camera::lens::open;
use rilievo::camera::{Paraxial, auto_exposure, tone_mapped};
use rilievo::gpu::Gpu;

const SIZE: [u32; 2] = [480, 320];

/// Peak signal-to-noise ratio, dB, and mean structural similarity (Wang et al. 2004, on 8 x 8 windows) of two 8-bit images, RGBA.
fn compare(a: &[u8], b: &[u8]) -> (f64, f64) {
    let pairs = a.iter().zip(b);
    let square: f64 = pairs.map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2)).sum();
    let psnr = 20.0 * 255_f64.log10() - 10.0 * (square / (0.75 * a.len() as f64)).max(1e-9).log10();
    let grey = |image: &[u8]| -> Vec<f64> {
        let pixels = image.chunks_exact(4);
        pixels
            .map(|p| 0.2126 * f64::from(p[0]) + 0.7152 * f64::from(p[1]) + 0.0722 * f64::from(p[2]))
            .collect()
    };
    let (a, b) = (grey(a), grey(b));
    let (width, height) = (SIZE[0] as usize, SIZE[1] as usize);
    let (mut sum, mut windows) = (0.0, 0.0);
    for y in (0..height - 7).step_by(4) {
        for x in (0..width - 7).step_by(4) {
            let (mut ma, mut mb, mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for k in 0..64 {
                let index = (y + k / 8) * width + x + k % 8;
                let (p, q) = (a[index], b[index]);
                ma += p / 64.0;
                mb += q / 64.0;
                aa += p * p / 64.0;
                bb += q * q / 64.0;
                ab += p * q / 64.0;
            }
            let (c1, c2) = ((0.01_f64 * 255.0).powi(2), (0.03_f64 * 255.0).powi(2));
            let (va, vb, cov) = (aa - ma * ma, bb - mb * mb, ab - ma * mb);
            sum += (2.0 * ma * mb + c1) * (2.0 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
            windows += 1.0;
        }
    }
    (psnr, sum / windows)
}

/// Peak signal-to-noise ratio of linear radiance, white = 1 at an exposure, dB.
fn linear_psnr(a: &[[f32; 3]], b: &[[f32; 3]], exposure: f32) -> f64 {
    let value = |v: f32| f64::from((v * exposure).min(1.0));
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    let square: f64 = pairs.map(|(&a, &b)| (value(a) - value(b)).powi(2)).sum();
    -10.0 * (square / (3 * a.len()) as f64).max(1e-12).log10()
}

/// Mean and least of PSNR and SSIM over angles to 20 degrees.
fn reach(gpu: &Gpu, file: &str, f_number: f64) -> [f64; 4] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fixtures/lenses")
        .join(file);
    let name = if path.exists() {
        path.to_str().unwrap()
    } else {
        file
    };
    let lens = Arc::new(open(name).unwrap());
    let corner = 0.5 * lens.film_mm[0].hypot(lens.film_mm[1]);
    let corner = corner.atan2(Paraxial::new(&lens, 0.587_56, None).efl_mm.abs());
    let start = Instant::now();
    let folder = tempfile::tempdir().unwrap();
    let file_path = folder.path().join("t.flare");
    let baked = FlareTable::bake(&lens, f_number, (1.35 * corner).clamp(0.37, 1.2));
    let seconds = start.elapsed().as_secs_f64();
    let bytes = write_table(&file_path, &lens, GhostTable::of_rays(baked)).unwrap();
    let table = Arc::new(open_table(&file_path, &lens, f_number).unwrap());
    let mut imager = FlareImager::new(gpu);
    let (mut all, mut least, mut linear) = ([0.0; 2], [f64::INFINITY; 2], 0.0);
    let angles = [0.4_f64, 2.9, 5.3, 7.7, 10.6, 13.1, 16.3, 19.4];
    for degrees in angles {
        let mut drawn = |mode, rays, table: Option<&Arc<GhostTable>>| {
            let request = FlareRequest {
                lens: Arc::clone(&lens),
                f_number,
                aperture: Aperture::default(),
                ghosts: Some(GhostParameters {
                    mode,
                    rays,
                    ..Quality::Medium.preset().ghosts()
                }),
                starburst: None,
                table: table.cloned(),
                light: FlareLight {
                    angular_radius: rilievo::space::SOLAR_ANGULAR_RADIUS,
                    ..FlareLight::point(degrees.to_radians(), 0.5)
                },
                image_half_mm: film_half_mm(&lens, SIZE),
            };
            imager.draw(&request, SIZE).unwrap().radiance
        };
        let dense = drawn(FlareMode::Exact, 80, None);
        let evaluated = drawn(FlareMode::Blended, 40, Some(&table));
        let exposure = auto_exposure(&dense);
        linear += linear_psnr(&dense, &evaluated, exposure) / angles.len() as f64;
        let (psnr, ssim) = compare(&tone_mapped(&dense, exposure), &tone_mapped(&evaluated, exposure));
        for (k, value) in [psnr, ssim].into_iter().enumerate() {
            all[k] += value / angles.len() as f64;
            least[k] = least[k].min(value);
        }
    }
    println!(
        "{file} f/{f_number}: {:.2} dB (least {:.2}), SSIM {:.4} (least {:.4}), in linear light {linear:.2} dB; {:.2} MB, baked in {seconds:.1} s",
        all[0],
        least[0],
        all[1],
        least[1],
        bytes as f64 * 1e-6
    );
    [all[0], least[0], all[1], least[1]]
}

fn hold(lenses: &[(&str, f64)]) {
    let gpu = Gpu::open().unwrap();
    for &(file, f_number) in lenses {
        let [psnr, least_psnr, ssim, least_ssim] = reach(&gpu, file, f_number);
        assert!(psnr > 32.0 && ssim > 0.985, "{file}: {psnr} dB, {ssim}");
        // What KR 10-1658883 states.
        assert!(
            least_psnr > 26.91 && least_ssim > 0.977,
            "{file}: {least_psnr} dB, {least_ssim}"
        );
    }
}

#[test]
fn tables_hold_for_other_lenses() {
    hold(&[
        ("fisheye.dat", 8.0),
        ("double_gauss.dat", 5.6),
        ("wide.dat", 8.0),
        ("triplet", 5.6),
        ("itoh", 8.0),
        ("phone.toml", 4.0),
        ("sonnar.toml", 5.6),
        ("telephoto.toml", 8.0),
        ("topogon.toml", 16.0),
        ("petzval.toml", 4.0),
    ]);
}

/// Those that take minutes: `cargo test --release --test tables -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn tables_hold_for_lenses_of_many_surfaces() {
    hold(&[
        ("zoom_short.toml", 8.0),
        ("zoom_long.toml", 8.0),
        ("phone_plastic.toml", 2.0),
        ("biogon.toml", 8.0),
        ("retrofocus.toml", 5.6),
        ("lowenthal.toml", 4.0),
        ("dagor.toml", 11.0),
    ]);
}
