//! `rilievo bench`: frame times by GPU timestamps and wall clock, bytes resident, reads per ray.

use std::path::{Path, PathBuf};
use std::time::Instant;

use glam::DVec3;
use serde::Deserialize;
use serde_json::{Value, json};

use super::CommandError;
use super::render::{light, size};
use super::statistics::median;
use crate::buildings::Building;
use crate::city::City;
use crate::output::{PictureRequest, Renderer};
use crate::relief::{CpuMap, ReliefMode};
use crate::scene::{Frustum, TerrainMesh};
use crate::space::View;

/// Flags of `bench`.
#[derive(Debug, clap::Args)]
pub struct BenchArgs {
    /// The city folder.
    #[arg(required_unless_present = "flare")]
    city: Option<PathBuf>,
    /// Time the flares of the built-in lenses instead: each way of making ghosts, sun at 5 degrees, f/8.
    #[arg(long, conflicts_with_all = ["city", "path"])]
    flare: bool,
    /// Views: a JSON list of {"name", "eye": [E,N,H], "look": [E,N,H], "fov": degrees} [default: low, oblique and high
    /// over the centre, and the whole city from above].
    #[arg(long)]
    path: Option<PathBuf>,
    /// Picture size, pixels.
    #[arg(long, default_value = "1280x720", value_parser = size)]
    size: [u32; 2],
    /// Frames a view; the median counts.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    frames: u32,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// One view of a path.
#[derive(Clone, Debug, Deserialize)]
struct PathView {
    name: String,
    eye: [f64; 3],
    look: [f64; 3],
    #[serde(default = "default_fov")]
    fov: f64,
}

fn default_fov() -> f64 {
    60.0
}

/// Times both ways of drawing.
pub fn run(args: &BenchArgs) -> Result<(), CommandError> {
    let Some(folder) = &args.city else {
        return super::bench_flare::run(args.size, args.frames, args.json);
    };
    let city = City::open(folder)?;
    let views = match &args.path {
        Some(path) => read_path(path)?,
        None => default_views(&city, args.size)?,
    };
    let mut renderer = Renderer::open(&city, ReliefMode::Exact, TerrainMesh::Tin)?;
    let buildings = renderer.load_polygons(&city)?;
    let cpu_map = CpuMap::new(&city, renderer.resident.highest_roof);
    let mut rows = Vec::new();
    for view in &views {
        let pose = View {
            eye: DVec3::from_array(view.eye),
            look: DVec3::from_array(view.look),
            fov_y: view.fov.to_radians(),
        };
        let in_view = buildings_in_view(&buildings, &pose, args.size);
        let reads = reads_per_ray(&cpu_map, &pose, args.size);
        for mode in [ReliefMode::Exact, ReliefMode::Polygons] {
            let request = PictureRequest {
                view: pose,
                size: args.size,
                light: light(None, city.manifest().place)?,
                mode,
                samples: 1,
            };
            let mut times = Vec::new();
            for _ in 0..args.frames {
                let start = Instant::now();
                let picture = renderer.picture(&request)?;
                let wall_ms = start.elapsed().as_secs_f64() * 1e3;
                times.push((wall_ms, picture.pass_ms.unwrap_or_default()));
            }
            let pass =
                |index: usize| median(times.iter().filter_map(|(_, passes)| passes.get(index).copied()));
            rows.push(json!({
                "view": view.name,
                "buildings_in_view": in_view,
                "relief": if mode == ReliefMode::Exact { "exact" } else { "polygons" },
                "ground_ms": pass(0),
                "buildings_ms": pass(1),
                "light_ms": pass(2),
                "wall_ms": median(times.iter().map(|(wall, _)| *wall)),
                "reads_per_ray": (mode == ReliefMode::Exact).then_some(reads),
            }));
        }
    }
    let report = json!({
        "device": renderer.gpu.adapter_name,
        "size": args.size,
        "frames": args.frames,
        "buildings": city.manifest().buildings,
        "resident_bytes": renderer.resident.bytes,
        "views": rows,
    });
    if args.json {
        say!("{report}");
    } else {
        print_table(&report);
    }
    Ok(())
}

fn print_table(report: &Value) {
    say!(
        "{}: {} buildings, {} bytes resident",
        report["device"],
        report["buildings"],
        report["resident_bytes"]
    );
    say!(
        "{:10} {:>8} {:10} {:>10} {:>13} {:>10} {:>10} {:>14}",
        "view",
        "in view",
        "relief",
        "ground ms",
        "buildings ms",
        "light ms",
        "wall ms",
        "reads per ray"
    );
    for row in report["views"].as_array().into_iter().flatten() {
        let number = |key: &str| {
            row[key]
                .as_f64()
                .map_or("-".to_owned(), |value| format!("{value:.1}"))
        };
        say!(
            "{:10} {:>8} {:10} {:>10} {:>13} {:>10} {:>10} {:>14}",
            row["view"].as_str().unwrap_or(""),
            row["buildings_in_view"].as_u64().unwrap_or_default(),
            row["relief"].as_str().unwrap_or(""),
            number("ground_ms"),
            number("buildings_ms"),
            number("light_ms"),
            number("wall_ms"),
            number("reads_per_ray")
        );
    }
}

/// Buildings of which at least a part may lie in the picture, hidden ones too.
fn buildings_in_view(buildings: &[Building], view: &View, size: [u32; 2]) -> usize {
    let frustum = Frustum::new(view.projection(size).clip_from_eye_relative(), view.eye);
    let is_in_view =
        |building: &&Building| frustum.sees(&building.bounds(), building.base_m, building.roof_m);
    buildings.iter().filter(is_in_view).count()
}

fn reads_per_ray(map: &CpuMap<'_>, view: &View, size: [u32; 2]) -> f64 {
    let projection = view.projection(size);
    const STRIDE: usize = 16;
    let (mut rays, mut reads) = (0_u64, 0_u64);
    for row in (0..size[1]).step_by(STRIDE) {
        for column in (0..size[0]).step_by(STRIDE) {
            let (_, count) = map.cast(view.eye, projection.ray_direction(column, row), f32::INFINITY);
            rays += 1;
            reads += u64::from(count);
        }
    }
    reads as f64 / rays.max(1) as f64
}

fn read_path(path: &Path) -> Result<Vec<PathView>, CommandError> {
    let failed = |why: String| CommandError::File {
        path: path.display().to_string(),
        why,
    };
    let text = std::fs::read(path).map_err(|error| failed(error.to_string()))?;
    serde_json::from_slice(&text).map_err(|error| failed(format!("is no list of views ({error})")))
}

/// A low, an oblique and a high view over the centre, and one from above that shows the whole city.
fn default_views(city: &City, size: [u32; 2]) -> Result<Vec<PathView>, CommandError> {
    let bounds = city.manifest().grid.bounds();
    let centre = bounds.centre();
    let tile = city.manifest().grid.tile_at(centre);
    let ground = match tile {
        Some(tile) => city.terrain(tile)?.and_then(|terrain| terrain.ground.range()),
        None => None,
    };
    let top = f64::from(ground.map_or(0.0, |[_, high]| high));
    let reach = 0.25 * bounds.width().min(bounds.height());
    // Far enough for the city's sides to fit, with a tenth to spare.
    let half_view = (0.5 * default_fov()).to_radians().tan();
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let far = 0.55 * (bounds.height() / half_view).max(bounds.width() / (half_view * aspect));
    let view = |name: &str, back: f64, up: f64| PathView {
        name: name.to_owned(),
        eye: [centre.x - back, centre.y - back, top + up],
        look: [centre.x, centre.y, top],
        fov: default_fov(),
    };
    Ok(vec![
        view("low", 0.4 * reach, 60.0),
        view("oblique", 0.4 * reach, 0.35 * reach),
        view("high", 0.6 * reach, 1.6 * reach),
        PathView {
            eye: [centre.x, centre.y - 0.02 * far, top + far],
            ..view("whole", 0.0, far)
        },
    ])
}
