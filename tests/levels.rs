//! The quadtree's levels and the tile pool: what coarse tiles keep, what a view wants, what stays within the budget, and what is shown
//! where a tile cannot be.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::collections::BTreeMap;
use std::fs;

use glam::DVec3;
use rilievo::buildings::{BLOCK, BuildingMap, CellKind, FootprintMask};
use rilievo::city::{City, Layer};
use rilievo::gpu::Gpu;
use rilievo::output::{Renderer, Still};
use rilievo::scene::{PoolOptions, TerrainMesh};
use rilievo::space::{Sun, TileId};
use support::View;

const SIZE: [u32; 2] = [160, 90];

fn sample_city() -> City {
    City::open(&support::sample().join("city")).unwrap()
}

fn view(eye: [f64; 3], target: [f64; 3]) -> View {
    View {
        eye: DVec3::from_array(eye),
        target: DVec3::from_array(target),
        fov_y: 40_f64.to_radians(),
    }
}

fn draw(renderer: &mut Renderer, view: View) -> Still {
    let (camera, sun) = (view.camera(), Sun::from_azimuth_altitude(210.0, 45.0));
    renderer.still(&support::request(&camera, &sun, SIZE), 1).unwrap()
}

/// Square metres under roofs that show, and the roofs by id.
fn shown(map: &BuildingMap) -> (f64, BTreeMap<u32, f32>) {
    let texel_m2 = f64::from(map.texel_m * map.texel_m);
    let (mut area, mut roofs) = (0.0, BTreeMap::new());
    for (_, codes) in map.occupied_blocks() {
        for &code in &codes {
            if let Some(index) = map.roof_at_reference(code) {
                let roof = map.roofs[index as usize];
                area += texel_m2;
                roofs.insert(roof.fid, roof.roof_m);
            }
        }
    }
    (area, roofs)
}

/// Roofs keep their elevation on every level; what shows covers as much ground as before while buildings are some texels large; and a
/// tile's range holds all that lies under it.
#[test]
fn coarse_maps_keep_elevations_and_area() {
    let city = sample_city();
    let grid = city.manifest().grid;
    let (mut areas, mut finest) = (Vec::new(), BTreeMap::new());
    for level in 0..grid.levels() {
        let mut area = 0.0;
        for id in grid.tiles_of_level(level) {
            let Some(map) = city.buildings(id).unwrap() else {
                continue;
            };
            let (shown_area, roofs) = shown(&map);
            area += shown_area;
            for (fid, roof) in roofs {
                let known = *finest.entry(fid).or_insert(roof);
                assert!(
                    roof == known,
                    "level {level}: {fid} is {roof} m high, was {known}"
                );
            }
            if level > 0 {
                for child in grid.children(id) {
                    let Some(child) = city.buildings(child).unwrap() else {
                        continue;
                    };
                    assert!(map.height_range[0] <= child.height_range[0]);
                    assert!(map.height_range[1] >= child.height_range[1]);
                }
            }
        }
        areas.push(area);
    }
    println!("square metres under roofs by level: {areas:?}");
    // Houses of the sample are about 10 m wide: up to level 2 they are more than two texels.
    for (level, area) in areas.iter().enumerate().take(3) {
        let off = area / areas[0] - 1.0;
        assert!(off.abs() < 0.05, "level {level}: {off}");
    }
}

/// A texel of a coarse map is covered as much as the four below it together.
#[test]
fn coverage_is_that_of_the_texels_below() {
    let city = sample_city();
    let grid = city.manifest().grid;
    let full_of = |map: &BuildingMap, x: usize, y: usize| match CellKind::from_code(map.code(x, y)) {
        CellKind::Full(full) => f64::from(full.coverage) / 63.0,
        CellKind::Empty => 0.0,
        _ => f64::from(u8::from(map.roof_at_reference(map.code(x, y)).is_some())),
    };
    let mut checked = 0;
    for level in 1..grid.levels() {
        for id in grid.tiles_of_level(level) {
            let Some(map) = city.buildings(id).unwrap() else {
                continue;
            };
            let children = grid.children(id).map(|child| city.buildings(child).unwrap());
            for ([block_x, block_y], _) in map.occupied_blocks().step_by(7) {
                for texel in 0..BLOCK * BLOCK {
                    let (x, y) = (BLOCK * block_x + texel % BLOCK, BLOCK * block_y + texel / BLOCK);
                    let half = map.side / 2;
                    let quadrant = x / half + 2 * (y / half);
                    let below = children[quadrant].as_ref().map_or(0.0, |child| {
                        let at =
                            |dx: usize, dy: usize| full_of(child, 2 * (x % half) + dx, 2 * (y % half) + dy);
                        0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
                    });
                    let own = full_of(&map, x, y);
                    // A coverage is stored in sevenths.
                    assert!(
                        (own - below).abs() <= 0.5 / 7.0 + 1e-6,
                        "level {level}: {own} of {below}"
                    );
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 10_000, "{checked}");
}

/// Terrain of a coarse level departs from the finest by no more than its stated error.
#[test]
fn terrain_errors_hold() {
    let city = sample_city();
    let grid = city.manifest().grid;
    let errors = city.terrain_errors().unwrap();
    let mut finest = BTreeMap::new();
    for id in grid.tiles() {
        if let Some(terrain) = city.terrain(id).unwrap() {
            finest.insert(id, terrain.ground);
        }
    }
    for level in 1..grid.levels() {
        let [columns, _] = grid.counts(level);
        for id in grid.tiles_of_level(level) {
            let Some(terrain) = city.terrain(id).unwrap() else {
                continue;
            };
            let stated = f64::from(errors[level as usize - 1][id.y as usize * columns + id.x as usize]);
            let origin = grid.origin(id);
            let mut worst = 0.0_f64;
            for (fine, ground) in &finest {
                if fine.x >> level != id.x || fine.y >> level != id.y {
                    continue;
                }
                // Between samples as well.
                for k in 0..61 * 61 {
                    let local = [k % 61, k / 61].map(|index| f64::from(index) / 60.0 * grid.tile_m);
                    let offset = grid.origin(*fine) - origin;
                    let truth = ground.ground(local[0], local[1]);
                    let coarse = terrain.ground.ground(local[0] + offset.x, local[1] + offset.y);
                    if let (Some(truth), Some(coarse)) = (truth, coarse) {
                        worst = worst.max((truth - coarse).abs());
                    }
                }
            }
            assert!(worst <= stated + 1e-3, "{id:?}: {worst} m, stated {stated}");
        }
    }
}

/// Drawn with tiles twice as coarse as they would be, a view shows what the finest tiles show: a building is where one was within
/// a pixel, on nine of ten pixels the same one (houses are fractions of a pixel here, and each is met or missed at one point).
#[test]
fn a_distant_view_shows_what_the_finest_tiles_show() {
    let city = sample_city();
    let mut coarse = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let mut fine = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    // As for an image so large that every tile is wanted in full; and for one so small that a texel is a sixteenth of a pixel.
    fine.detail_size = Some([160_000, 90_000]);
    coarse.detail_size = Some([80, 45]);
    for (name, eye) in [
        ("low", [287_500.0, 4_771_500.0, 600.0]),
        ("oblique", [286_500.0, 4_770_500.0, 2000.0]),
        ("high", [288_000.0, 4_772_000.0, 5000.0]),
    ] {
        let view = view(eye, [289_279.0, 4_773_023.0, 230.0]);
        let (a, b) = (draw(&mut coarse, view), draw(&mut fine, view));
        let bytes = [&coarse, &fine].map(|renderer| renderer.resident.map_bytes());
        let [width, height] = SIZE.map(|side| side as usize);
        let (mut shown, mut right, mut off) = (0, 0, 0);
        for k in 0..width * height {
            let inner = k % width > 0 && k % width + 1 < width && k / width > 0 && k / width + 1 < height;
            if b.ids[k] == 0 || !inner {
                continue;
            }
            shown += 1;
            right += u32::from(a.ids[k] == b.ids[k]);
            // The edge of what is built moved by more than a pixel: where a building was none is near.
            let is_near = |n: i64| a.ids[(k as i64 + (n / 3 - 1) * width as i64 + n % 3 - 1) as usize] != 0;
            off += u32::from(!(0..9).any(is_near));
        }
        println!(
            "{name}: {right} of {shown} the same, {off} off by more than a pixel, {bytes:?} bytes of maps"
        );
        assert!(shown > 200, "{name}: {shown}");
        assert!(
            f64::from(right) >= 0.9 * f64::from(shown),
            "{name}: {right} of {shown}"
        );
        assert!(
            100 * off <= shown,
            "{name}: {off} edges of {shown} moved by more than a pixel"
        );
    }
}

/// No sky is seen through the ground: wherever a ray of a random view into the city meets the ground, the picture has ground or a
/// building.
#[test]
fn no_view_has_a_crack_in_the_ground() {
    let city = sample_city();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    // Coarser than such a view would be drawn, so that tiles of many levels meet.
    renderer.detail_size = Some([24, 13]);
    let mut everywhere = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    everywhere.load_finest().unwrap();
    let tiles = &everywhere.resident.tiles;
    let size = [48, 27];
    let sun = Sun::from_azimuth_altitude(210.0, 45.0);
    let random = |k: u32, step: f64| (f64::from(k) * step).fract();
    let (mut views, mut seen, mut cracks) = (0, 0, 0);
    for k in 1..=1400 {
        let centre = tiles.grid.bounds().centre();
        let spread = 1200.0;
        let at = |a: f64, b: f64| centre + spread * glam::DVec2::new(2.0 * a - 1.0, 2.0 * b - 1.0);
        let from = at(random(k, 0.754_877_666), random(k, 0.569_840_29));
        let to = at(random(k, 0.819_172_513), random(k, 0.671_043_606));
        // An eye below the ground sees through it.
        let Some(ground) = tiles.ground_at(from) else {
            continue;
        };
        let height = 2.0 * 1500_f64.powf(random(k, 0.618_033_988));
        let eye = from.extend(ground + height);
        let target = to.extend(tiles.ground_at(to).unwrap_or(230.0));
        let view = View {
            eye,
            target,
            fov_y: 1.0,
        };
        views += 1;
        let camera = view.camera();
        let still = renderer.still(&support::request(&camera, &sun, size), 1).unwrap();
        for pixel in 0..size[0] * size[1] {
            let (column, row) = (pixel % size[0], pixel / size[0]);
            if !still.depth[pixel as usize].is_nan() {
                seen += 1;
                continue;
            }
            // Sky: then the rays beside it see sky as well, or this is the horizon.
            let meets = |dx: i32, dy: i32| {
                let ray = support::ray(
                    &view,
                    size,
                    column.saturating_add_signed(dx),
                    row.saturating_add_signed(dy),
                );
                rilievo::relief::cast_ground(tiles, eye, ray, 1e5).is_some()
            };
            let around = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)];
            let is_crack = around.iter().all(|&(dx, dy)| meets(dx, dy));
            cracks += u32::from(is_crack);
        }
    }
    println!("{cracks} cracks beside {seen} pixels of ground in {views} views");
    assert!(views >= 1000 && seen > 500_000, "{views} views, {seen}");
    assert_eq!(cracks, 0);
}

/// A scripted flight stays within the budget, whatever it passes, and frames do not wait; at rest the image is the one that waits.
#[test]
fn a_flight_stays_within_its_budget() {
    let city = sample_city();
    let budget = 24_000_000;
    let options = PoolOptions {
        budget,
        streams: true,
        ..PoolOptions::default()
    };
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, options).unwrap();
    let sun = Sun::from_azimuth_altitude(210.0, 45.0);
    let mut most = 0;
    for step in 0..60 {
        let along = 50.0 * f64::from(step);
        let eye = [287_800.0 + along, 4_772_200.0 + 0.5 * along, 420.0];
        let view = view(eye, [eye[0] + 400.0, eye[1] + 300.0, 230.0]);
        let camera = view.camera();
        renderer.frame(&support::request(&camera, &sun, SIZE), 0).unwrap();
        most = most.max(renderer.resident.bytes());
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    println!("{most} bytes at most of {budget}");
    assert!(most <= budget, "{most}");

    let resting = view([288_900.0, 4_772_500.0, 1000.0], [289_230.0, 4_773_050.0, 215.0]);
    let camera = resting.camera();
    let request = support::request(&camera, &sun, SIZE);
    let mut frames = 0;
    loop {
        renderer.frame(&request, 0).unwrap();
        frames += 1;
        if !renderer.resident.is_loading() {
            break;
        }
        assert!(frames < 2000, "tiles never come");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let streamed = renderer.still(&request, 1).unwrap();
    let waits = PoolOptions {
        budget,
        ..PoolOptions::default()
    };
    let mut waiting = Renderer::open(Gpu::open().unwrap(), &city, waits).unwrap();
    let waited = waiting.still(&request, 1).unwrap();
    assert!(streamed.ids == waited.ids, "other buildings");
}

/// A damaged tile is shown by the coarser one over it and told once; a damaged coarsest one is an error.
#[test]
fn a_damaged_tile_is_shown_coarser() {
    let folder = tempfile::tempdir().unwrap();
    let path = support::copied(folder.path());
    let city = City::open(&path).unwrap();
    let id = city
        .manifest()
        .grid
        .tile_at(glam::DVec2::new(289_230.0, 4_773_050.0))
        .unwrap();
    fs::write(Layer::Buildings.tile_path(&path, id), b"not a tile").unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let view = view([288_900.0, 4_772_500.0, 1000.0], [289_230.0, 4_773_050.0, 215.0]);
    let still = draw(&mut renderer, view);
    let warnings = renderer.resident.take_warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains(".tif"), "{warnings:?}");
    let mut whole = Renderer::open(Gpu::open().unwrap(), &sample_city(), TerrainMesh::Tin).unwrap();
    let expected = draw(&mut whole, view);
    let same = still
        .ids
        .iter()
        .zip(&expected.ids)
        .filter(|(a, b)| a == b)
        .count();
    let shown = expected.ids.iter().filter(|&&id| id != 0).count();
    let kept = still.ids.iter().filter(|&&id| id != 0).count();
    println!(
        "{same} of {} pixels the same, {kept} of {shown} show buildings",
        still.ids.len()
    );
    assert!(10 * kept > 9 * shown, "its buildings are gone");
    draw(&mut renderer, view);
    assert!(renderer.resident.take_warnings().is_empty(), "told twice");

    let root = TileId {
        level: city.manifest().grid.levels() - 1,
        x: 0,
        y: 0,
    };
    fs::write(Layer::Buildings.tile_path(&path, root), b"not a tile").unwrap();
    assert!(Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).is_err());
}

/// A footprint mask covers as much ground on every level as the roofs that the finest shows.
#[test]
fn masks_cover_what_buildings_cover() {
    let city = sample_city();
    let grid = city.manifest().grid;
    let mut areas = Vec::new();
    let mut roofs = 0.0;
    for level in 0..3 {
        let side = 1_u32 << level;
        let mut area = 0.0;
        for (x, y) in
            (0..grid.columns.div_ceil(side)).flat_map(|x| (0..grid.rows.div_ceil(side)).map(move |y| (x, y)))
        {
            let Some(map) = city.buildings(TileId { level, x, y }).unwrap() else {
                continue;
            };
            let mask = FootprintMask::from_map(&map);
            let cell_m = grid.level_tile_m(level) / mask.side() as f64;
            let cells = (0..mask.side().pow(2)).filter(|k| mask.is_covered(k % mask.side(), k / mask.side()));
            area += cells.count() as f64 * cell_m * cell_m;
            if level == 0 {
                roofs += shown(&map).0;
            }
        }
        areas.push(area);
    }
    println!("roofs {roofs:.0} m2, masks {areas:.0?}");
    assert!(
        areas.iter().all(|area| (area / roofs - 1.0).abs() < 0.08),
        "{roofs} {areas:?}"
    );
}
