//! The facade coordinate: bays along a building's outline, whole from corner to corner, against the survey's own rings.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::collections::{HashMap, HashSet};

use gdal::vector::LayerAccess;
use glam::DVec2;
use rilievo::city::City;
use rilievo::gpu::{Gpu, read_texture};
use rilievo::material::{FacadeBand, FacadeStyle, paint_facade};
use rilievo::output::Renderer;
use rilievo::scene::TerrainMesh;
use rilievo::space::Sun;

const SIZE: [u32; 2] = [320, 180];

/// A closed ring.
struct Ring(Vec<DVec2>);

/// A point on a wall run, between two corners of a ring.
struct OnRun {
    /// The ring's vertex that the run begins at.
    first: usize,
    /// Metres along the run, and of all of it.
    metres: f64,
    length: f64,
    /// Metres from the point asked for.
    away: f64,
}

impl Ring {
    fn edge(&self, k: usize) -> DVec2 {
        let count = self.0.len() - 1;
        self.0[k % count + 1] - self.0[k % count]
    }

    /// Whether the outline turns by more than 25 degrees at a vertex.
    fn is_corner(&self, k: usize) -> bool {
        let count = self.0.len() - 1;
        self.edge(k + count - 1).angle_to(self.edge(k)).abs() > 25_f64.to_radians()
    }

    /// Where on which run the nearest point of the ring lies; none of a ring without corners.
    fn on_run(&self, point: DVec2) -> Option<OnRun> {
        let count = self.0.len() - 1;
        let distance = |k: usize| {
            let edge = self.edge(k);
            let fraction = ((point - self.0[k]).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
            (point.distance(self.0[k] + fraction * edge), fraction)
        };
        let nearest = (0..count).min_by(|&a, &b| distance(a).0.total_cmp(&distance(b).0))?;
        let (away, fraction) = distance(nearest);
        let back = (0..count).find(|back| self.is_corner(nearest + count - back))?;
        let first = (nearest + count - back) % count;
        let edges = 1 + (1..=count).find(|&k| self.is_corner(first + k))? - 1;
        let lengths =
            |range: std::ops::Range<usize>| range.map(|k| self.edge(first + k).length()).sum::<f64>();
        Some(OnRun {
            first,
            metres: lengths(0..back) + fraction * self.edge(nearest).length(),
            length: lengths(0..edges),
            away,
        })
    }
}

/// Outer rings of the footprints without courtyards, by id, read by OGR alone.
fn rings() -> HashMap<u32, Ring> {
    let dataset = gdal::Dataset::open(support::sample().join("files/buildings.gpkg")).unwrap();
    let mut layer = dataset.layer(0).unwrap();
    let simple = layer.features().filter_map(|feature| {
        let geometry = feature.geometry()?;
        if geometry.geometry_count() != 1 {
            return None;
        }
        let mut points = Vec::new();
        geometry.get_geometry(0).get_points(&mut points);
        let ring = points.iter().map(|&(x, y, _)| DVec2::new(x, y)).collect();
        Some((feature.fid()? as u32, Ring(ring)))
    });
    simple.collect()
}

#[test]
fn the_facade_coordinate_is_whole_bays_from_corner_to_corner() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let rings = rings();
    let (mut walls, mut buildings, mut wrong) = (0, 0, 0);
    let mut corners = 0;
    for (name, eye, target) in &support::VIEWS[..2] {
        let camera = support::pinhole(*eye, *target, 1.0);
        let sun = Sun::from_azimuth_altitude(200.0, 40.0);
        renderer.still(&support::request(&camera, &sun, SIZE), 1).unwrap();
        let targets = renderer.relief_targets().unwrap();
        let surfaces = read_texture::<[u32; 4]>(&renderer.gpu, &targets.building_surface.texture).unwrap();
        let facades = read_texture::<[u32; 4]>(&renderer.gpu, &targets.building_facade.texture).unwrap();
        let shown = read_texture::<u32>(&renderer.gpu, &targets.id.texture).unwrap();
        let projection = camera.projection(SIZE);
        // Per building: where the survey has a wall's point on its run, and the facade coordinate of the image.
        let mut points: HashMap<u32, Vec<(OnRun, f64)>> = HashMap::new();
        for (k, &[t, id, bays, _]) in surfaces.iter().enumerate() {
            let bays_per_m = f32::from_bits(facades[k][0]);
            if id == 0 || shown[k] != id || bays_per_m == 0.0 {
                continue;
            }
            let Some(ring) = rings.get(&id) else { continue };
            let ray = projection.ray_direction(k as u32 % SIZE[0], k as u32 / SIZE[0]);
            let at = camera.pose.eye + ray * f64::from(f32::from_bits(t));
            let Some(run) = ring.on_run(at.truncate()) else {
                continue;
            };
            assert!(
                run.away < 0.1,
                "{name}: a wall of {id} lies {} m off its outline",
                run.away
            );
            // Bays come near to the width that the facade asks for.
            let whole = f64::from(bays_per_m) * run.length;
            assert!(
                (whole - whole.round()).abs() < 1e-2 && whole > 0.5,
                "{id}: {whole} bays on {} m",
                run.length
            );
            points
                .entry(id)
                .or_default()
                .push((run, f64::from(f32::from_bits(bays))));
            walls += 1;
        }
        for (id, points) in points {
            let facade = facades[surfaces.iter().position(|surface| surface[1] == id).unwrap()][3];
            let style = FacadeStyle::ALL[(facade & 127) as usize];
            // The ring may be walked the other way.
            let off = |sign: f64| {
                let errors = points.iter().map(|(run, bays)| {
                    let count = (run.length / style.bay_m()).round().max(1.0);
                    let apart = (bays - sign * run.metres / run.length * count).rem_euclid(1.0);
                    apart.min(1.0 - apart) * run.length / count
                });
                errors.filter(|&error| error > 0.15).count()
            };
            wrong += off(1.0).min(off(-1.0));
            buildings += 1;
            let firsts: HashSet<usize> = points.iter().map(|(run, _)| run.first).collect();
            corners += u32::from(firsts.len() > 1);
        }
    }
    println!("{wrong} of {walls} wall pixels of {buildings} buildings differ, {corners} show a corner");
    assert!(
        walls > 5000 && buildings > 50 && corners > 20,
        "{walls}, {buildings}, {corners}"
    );
    assert!(wrong * 200 <= walls, "{wrong} of {walls} differ");
}

/// A facade far away has the mean colour of the same facade near by: its mips lose no light (linear light, every level of every tile).
#[test]
fn mips_keep_the_mean_colour() {
    let linear = |code: u8| {
        let value = f64::from(code) / 255.0;
        if value <= 0.040_45 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    };
    for style in FacadeStyle::ALL {
        for band in FacadeBand::ALL {
            let canvas = paint_facade(style, band);
            let exact = canvas.mean_albedo();
            for level in canvas.levels() {
                for channel in 0..3 {
                    let sum: f64 = level.colour.iter().map(|texel| linear(texel[channel])).sum();
                    let mean = sum / level.colour.len() as f64;
                    // The last levels have few texels: half a code is then seen.
                    let off = (mean - f64::from(exact[channel])).abs();
                    assert!(
                        off < 0.02 * f64::from(exact[channel]) + 0.001,
                        "{style:?} {band:?}: {mean} {exact:?}"
                    );
                }
            }
        }
    }
}

/// A wall seen from farther and farther away keeps its brightness, and a slow flight past it does not flicker: 60 frames, each two
/// centimetres on.
#[test]
fn facades_do_not_shimmer() {
    let city = City::open(&support::sample().join("city")).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let (_, eye, target) = support::VIEWS[0];
    let (eye, target) = (glam::DVec3::from_array(eye), glam::DVec3::from_array(target));
    let side = (target - eye).cross(glam::DVec3::Z).normalize();
    let size = [160, 90];
    let mut frames: Vec<Vec<[u8; 4]>> = Vec::new();
    let mut walls: Vec<bool> = Vec::new();
    for k in 0..60 {
        let moved = side * 0.02 * f64::from(k);
        let camera = support::pinhole((eye + moved).to_array(), (target + moved).to_array(), 1.0);
        let sun = Sun::from_azimuth_altitude(200.0, 40.0);
        let still = renderer.still(&support::request(&camera, &sun, size), 8).unwrap();
        frames.push(still.rgba.as_chunks::<4>().0.to_vec());
        let surfaces = {
            let targets = renderer.relief_targets().unwrap();
            read_texture::<[u32; 4]>(&renderer.gpu, &targets.building_facade.texture).unwrap()
        };
        // Far walls, which stay where they are in the image.
        let is_far = |index: usize| still.depth[index] > 60.0 && f32::from_bits(surfaces[index][0]) > 0.0;
        let far: Vec<bool> = (0..surfaces.len()).map(is_far).collect();
        walls = if k == 0 {
            far
        } else {
            walls.iter().zip(far).map(|(a, b)| *a && b).collect()
        };
    }
    let mut changes = Vec::new();
    for pair in frames.windows(2) {
        let both = pair[0]
            .iter()
            .zip(&pair[1])
            .zip(&walls)
            .filter(|(_, is_wall)| **is_wall);
        changes.extend(both.map(|((a, b), _)| (f64::from(a[1]) - f64::from(b[1])).powi(2)));
    }
    let variance = changes.iter().sum::<f64>() / changes.len() as f64;
    println!(
        "{} far wall pixels, mean square change of a frame {variance:.2} (of 255²)",
        walls.iter().filter(|w| **w).count()
    );
    assert!(changes.len() > 1000 && variance < 60.0, "{variance}");
}

/// Pictures of the user's own stand on the walls that the rules give them, go into the city folder with its rules, and are refused by name.
#[test]
fn facades_of_ones_own_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = folder.path().join("facades");
    std::fs::create_dir(&pictures).unwrap();
    // Two bays, one red and one blue, and a green ground floor.
    let write = |name: &str, colour: &dyn Fn(u32) -> [u8; 4]| {
        let pixels: Vec<u8> = (0..64 * 32).flat_map(|k| colour(k % 64)).collect();
        rilievo::output::write_png(&pictures.join(name), [64, 32], &pixels).unwrap();
    };
    write("bays.png", &|column| {
        if column < 32 {
            [200, 10, 10, 255]
        } else {
            [10, 10, 200, 255]
        }
    });
    write("ground.png", &|_| [10, 200, 10, 255]);
    let rules = folder.path().join("rules.toml");
    let text = "[[facade]]\nname = 'flag'\nbay_m = 4\nstorey_m = 3\nmiddle = 'bays.png'\nground = 'ground.png'\n\
                [[rule]]\nfacades = ['flag']\nroofs = ['gravel']\n";
    std::fs::write(&rules, text).unwrap();
    let out = folder.path().join("city");
    let mut import = support::import_arguments(&support::sample().join("files"), &out);
    import.extend(["--facades".to_owned(), rules.display().to_string()]);
    support::succeed(&import);
    assert!(out.join("facades/bays.png").is_file() && out.join("facades/ground.png").is_file());

    let city = City::open(&out).unwrap();
    let mut renderer = Renderer::open(Gpu::open().unwrap(), &city, TerrainMesh::Tin).unwrap();
    let (_, eye, target) = support::VIEWS[0];
    let camera = support::pinhole(eye, target, 1.0);
    let sun = Sun::from_azimuth_altitude(200.0, 40.0);
    renderer.still(&support::request(&camera, &sun, SIZE), 1).unwrap();
    let targets = renderer.relief_targets().unwrap();
    let surfaces = read_texture::<[u32; 4]>(&renderer.gpu, &targets.building_surface.texture).unwrap();
    let image: Vec<u8> = read_texture(&renderer.gpu, &renderer.image().unwrap().texture).unwrap();
    let (mut walls, mut seen) = (0, [0; 3]);
    for (k, pixel) in image.chunks_exact(4).enumerate() {
        if surfaces[k][1] == 0 {
            continue;
        }
        walls += 1;
        let strongest = (0..3).max_by_key(|&c| pixel[c]).unwrap();
        let others = (0..3)
            .filter(|&c| c != strongest)
            .map(|c| pixel[c])
            .max()
            .unwrap();
        seen[strongest] += u32::from(pixel[strongest] > others.saturating_mul(3) / 2 + 20);
    }
    println!("{walls} pixels of buildings: {seen:?} red, green, blue");
    assert!(
        seen.iter().all(|&count| count * 20 > walls),
        "{seen:?} of {walls}"
    );
    // Imported again, the city keeps its rules and pictures.
    support::succeed(&support::import_arguments(&support::sample().join("files"), &out));
    assert!(out.join("facades/bays.png").is_file());

    for (change, told) in [
        (text.replace("'ground.png'", "'../ground.png'"), "without a path"),
        (text.replace("'ground.png'", "'none.png'"), "none.png"),
        (text.replace("['flag']", "['marble']"), "marble"),
    ] {
        std::fs::write(&rules, change).unwrap();
        let output = support::rilievo(&import);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.code() == Some(1) && message.contains(told),
            "{message}"
        );
    }
}
