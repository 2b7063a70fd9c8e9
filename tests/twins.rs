//! The traversal's two forms, WGSL and Rust, meet the same walls and roofs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use glam::DVec3;
use rilievo::city::City;
use rilievo::output::{PictureRequest, Renderer};
use rilievo::relief::{CpuMap, Light, ReliefMode};
use rilievo::scene::TerrainMesh;
use rilievo::space::View;

#[test]
fn cpu_and_gpu_walks_agree() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let renderer = Renderer::open(&city, ReliefMode::Exact, TerrainMesh::Tin).unwrap();
    let map = CpuMap::new(&city, renderer.resident.highest_roof);
    let size = [160, 90];
    for (name, eye, look) in support::VIEWS {
        let view = View {
            eye: DVec3::from_array(eye),
            look: DVec3::from_array(look),
            fov_y: 1.0,
        };
        let light = Light { to_sun: DVec3::Z };
        let picture = renderer
            .picture(&PictureRequest {
                view,
                size,
                light,
                mode: ReliefMode::Exact,
                samples: 1,
            })
            .unwrap();
        let projection = view.projection(size);
        let (mut hits, mut differing) = (0, 0);
        for k in 0..(size[0] * size[1]) as usize {
            let direction = projection.ray_direction(k as u32 % size[0], k as u32 / size[0]);
            let (hit, reads) = map.cast(view.eye, direction, f32::INFINITY);
            assert!(reads < 4000, "a walk of {reads} reads");
            // Where the picture shows ground, a building may only lie behind it.
            let shown = (picture.ids[k] != 0).then(|| (picture.ids[k], picture.depth[k]));
            let same = match (hit, shown) {
                (Some(hit), Some((id, t))) => hit.fid == id && (hit.t - t).abs() < 0.01 + 1e-4 * t,
                (Some(hit), None) => hit.t > picture.depth[k],
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
