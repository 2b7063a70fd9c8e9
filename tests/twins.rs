//! The traversal's two forms, WGSL and Rust, meet the same walls and roofs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use glam::{DVec2, DVec3};
use rilievo::camera::lens::{BUILT_IN, D_LINE_UM, Lens, open};
use rilievo::camera::{Bundle, Paraxial, RayPass, Tracer, beam_direction, single_crossing_ghosts};
use rilievo::city::City;
use rilievo::gpu::Gpu;
use rilievo::output::Renderer;
use rilievo::relief::cast_buildings;
use rilievo::scene::TerrainMesh;
use rilievo::space::Sun;

#[test]
fn cpu_and_gpu_walks_agree() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let size = [160, 90];
    for (name, eye, target) in support::VIEWS {
        let camera = support::pinhole(eye, target, 1.0);
        let sun = Sun::from_direction(DVec3::Z);
        let still = renderer.still(&support::request(&camera, &sun, size), 1).unwrap();
        let projection = camera.projection(size);
        let tiles = &renderer.resident.tiles;
        let (mut hits, mut differing) = (0, 0);
        for k in 0..(size[0] * size[1]) as usize {
            let direction = projection.ray_direction(k as u32 % size[0], k as u32 / size[0]);
            let (hit, reads) = cast_buildings(tiles, camera.pose.eye, direction, f32::INFINITY);
            assert!(reads < 4000, "a walk of {reads} reads");
            // Where the image shows ground, a building may only lie behind it.
            let shown = (still.ids[k] != 0).then(|| (still.ids[k], still.depth[k]));
            let same = match (hit, shown) {
                (Some(hit), Some((id, t))) => hit.fid == id && (hit.t - t).abs() < 0.01 + 1e-4 * t,
                (Some(hit), None) => hit.t > still.depth[k],
                (None, None) => true,
                (None, Some(_)) => false,
            };
            hits += u32::from(shown.is_some());
            differing += u32::from(!same);
        }
        println!("{name}: {differing} of {hits} differ");
        assert!(hits > 1000, "{name} shows too few buildings");
        assert!(differing * 1000 <= hits, "{name}: {differing} of {hits} differ");
    }
}

/// Grids of rays over a lens's front, for all its ghosts in two colours.
fn bundles(lens: &Lens, angle_deg: f64, reach_mm: f64) -> Vec<Bundle> {
    let ghosts = single_crossing_ghosts(lens);
    let ways = std::iter::once(None).chain(ghosts.into_iter().map(Some));
    ways.flat_map(|ghost| {
        [0.475, 0.65].map(|wavelength_um| Bundle {
            ghost,
            wavelength_um,
            angle: f64::to_radians(angle_deg),
            min: DVec2::splat(-reach_mm),
            max: DVec2::new(reach_mm, 0.9 * reach_mm),
        })
    })
    .collect()
}

/// The lens tracer in f32 on the GPU and in f64 on the CPU, all built-in lenses and ghosts: rays that pass, in pixels of a
/// picture 1280 wide.
#[test]
fn cpu_and_gpu_rays_through_lenses_agree() {
    const SIDE: usize = 15;
    let gpu = Gpu::open().unwrap();
    let pass = RayPass::new(&gpu);
    let fixtures = ["phone", "phone_plastic", "sonnar"]
        .map(|name| format!("{}/tests/fixtures/lenses/{name}.toml", env!("CARGO_MANIFEST_DIR")));
    let built_in = BUILT_IN.iter().map(|(name, _)| (*name).to_owned());
    for name in built_in.chain(fixtures) {
        let lens = open(&name).unwrap();
        let gap = Paraxial::new(&lens, D_LINE_UM, None).sensor_gap_mm();
        let pixel_mm = lens.film_mm[0] / 1280.0;
        let front_mm = lens.clear_radius(0).min(30.0);
        let (mut off_px, mut one_sided, mut power_off) = (Vec::new(), 0, 0.0_f64);
        for angle_deg in [0.0, 5.0, 15.0] {
            let bundles = bundles(&lens, angle_deg, front_mm);
            let grids = pass.trace(&gpu, &lens, gap, &bundles, SIDE).unwrap();
            assert_eq!(grids.len(), bundles.len());
            for (bundle, grid) in bundles.iter().zip(&grids) {
                let tracer = Tracer::new(&lens, bundle.wavelength_um, gap);
                for (k, on_gpu) in grid.iter().enumerate() {
                    let share = DVec2::new((k % SIDE) as f64, (k / SIDE) as f64) / (SIDE - 1) as f64;
                    let entry = bundle.min + (bundle.max - bundle.min) * share;
                    let on_cpu = tracer.trace(bundle.ghost, entry, beam_direction(bundle.angle));
                    // Rays that the barrel holds may graze a surface, where f32 cannot follow.
                    let Some(on_cpu) = on_cpu.filter(|ray| ray.relative_height <= 1.0) else {
                        continue;
                    };
                    let Some(on_gpu) = on_gpu else {
                        one_sided += 1;
                        continue;
                    };
                    off_px.push(on_cpu.sensor_mm.distance(on_gpu.sensor_mm) / pixel_mm);
                    assert!(
                        on_cpu.stop_mm.distance(on_gpu.stop_mm) < 0.01,
                        "{name}: {bundle:?}"
                    );
                    assert!((on_cpu.relative_height - on_gpu.relative_height).abs() < 1e-3);
                    assert!((on_cpu.relative_stop - on_gpu.relative_stop).abs() < 1e-3);
                    power_off = power_off.max((on_cpu.power - on_gpu.power).abs() / on_cpu.power.max(1e-9));
                }
            }
        }
        off_px.sort_by(f64::total_cmp);
        let mean = off_px.iter().sum::<f64>() / off_px.len() as f64;
        let p99 = off_px[off_px.len() * 99 / 100];
        println!(
            "{name}: {} rays, mean {mean:.5} px, p99 {p99:.5} px, most {:.4} px, power off by {power_off:.1e}",
            off_px.len(),
            off_px[off_px.len() - 1]
        );
        assert!(off_px.len() > 1000, "{name}: only {} rays pass", off_px.len());
        assert!(mean < 0.05 && p99 < 1.0, "{name}: mean {mean}, p99 {p99} px");
        assert!(
            one_sided * 1000 <= off_px.len(),
            "{name}: {one_sided} rays lost on the GPU alone"
        );
        assert!(power_off < 0.02, "{name}: {power_off}");
    }
}
