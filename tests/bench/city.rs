//! Criterion benches of the parts whose cost follows the data: rasterising footprints and the greedy network.
//! `cargo bench`

use criterion::{Criterion, criterion_group, criterion_main};
use geo::polygon;
use rilievo::buildings::{Building, Pyramid, rasterise};
use rilievo::material::FacadeRules;
use rilievo::source::BuildingTraits;
use rilievo::space::Bounds;
use rilievo::terrain::{Apron, HeightTile, tin_triangles};

fn houses() -> Vec<Building> {
    (0..400)
        .map(|k| {
            let (x, y) = (f64::from(k % 20) * 25.0 + 5.3, f64::from(k / 20) * 25.0 + 4.1);
            let outline = polygon![(x: x, y: y), (x: x + 14.0, y: y + 3.0), (x: x + 11.0, y: y + 13.0), (x: x - 3.0, y: y + 10.0)];
            let (fid, outline) = (k as u32 + 1, outline.into());
            let material = FacadeRules::default().material(fid, &outline, 9.0, &BuildingTraits::default());
            Building { fid, outline, base_m: 0.0, roof_m: 9.0, material }
        })
        .collect()
}

fn benches(criterion: &mut Criterion) {
    let houses = houses();
    let tile = Bounds {
        west: 0.0,
        south: 0.0,
        east: 512.0,
        north: 512.0,
    };
    let of_tile: Vec<&Building> = houses.iter().collect();
    criterion.bench_function("rasterise 400 houses", |bencher| {
        bencher.iter(|| rasterise(&tile, 512, &of_tile));
    });
    if let Ok(map) = rasterise(&tile, 512, &of_tile) {
        criterion.bench_function("pyramid of a tile", |bencher| {
            bencher.iter(|| Pyramid::from_map(&map, 0.0))
        });
    }
    let side = 129;
    let height =
        |k: usize, wide: usize| ((k % wide) as f32 / 9.0).sin() * 8.0 + ((k / wide) as f32 / 5.0).cos() * 3.0;
    let ground = HeightTile {
        side,
        level: 0,
        step_m: 4.0,
        heights: (0..side * side).map(|k| height(k, side)).collect(),
    };
    let apron: Vec<f32> = (0..(side + 2) * (side + 2))
        .map(|k| height(k, side + 2))
        .collect();
    criterion.bench_function("TIN of 129 x 129 samples", |bencher| {
        bencher.iter(|| tin_triangles(&ground, &Apron(&apron), 0.25));
    });
}

criterion_group!(city, benches);
criterion_main!(city);
