//! `rilievo bench`: frame times by GPU timestamps and wall clock, bytes resident, reads per ray.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use serde_json::{Value, json};

use super::CommandError;
use super::bench_flare::F_NUMBER;
use super::camera_flags::sun;
use super::default_views::{DEFAULT_FOV_DEG, default_views};
use super::path_file::read_path;
use super::pool_flags::{PoolFlags, tell_warnings};
use super::statistics::median;
use super::values::size;
use crate::buildings::Building;
use crate::camera::flare::{Aperture, Quality};
use crate::camera::lens::open;
use crate::camera::{Camera, FULL_FRAME_MM, LensOptics, Optics, require_f_number};
use crate::city::City;
use crate::gpu::{Gpu, PassTimes};
use crate::output::{FlareSettings, FrameRequest, RenderError, Renderer};
use crate::relief::{ReliefMode, ReliefSettings, SearchParameters, cast_buildings};
use crate::scene::{Frustum, TerrainMesh, TileSet};
use crate::space::Projection;

/// Flags of `bench`.
#[derive(Debug, clap::Args)]
pub struct BenchArgs {
    /// The city folder.
    #[arg(required_unless_present = "flare")]
    city: Option<PathBuf>,
    /// Time the flares of the built-in lenses instead: each way of making ghosts, sun at 5 degrees, f/8.
    #[arg(long, conflicts_with_all = ["city", "path"])]
    flare: bool,
    /// A lens, a built-in one or a file: the city through it at f/8 and its own field of view, with its flare; with --flare this lens alone.
    #[arg(long)]
    lens: Option<String>,
    /// Local time with offset, for the sun [default: a pleasant sun].
    #[arg(long, conflicts_with = "flare")]
    time: Option<String>,
    /// Views: a flight path, a JSON list of {"name", "eye": [E,N,H], "look": [E,N,H], "fov": degrees} [default: low, oblique and high
    /// over the centre, and the whole city from above].
    #[arg(long)]
    path: Option<PathBuf>,
    /// Picture size, pixels.
    #[arg(long, default_value = "1280x720", value_parser = size)]
    size: [u32; 2],
    /// Frames a view; the median counts.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    frames: u32,
    /// The search of KR 10-0738500 as well, by so many slices each.
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=4096), conflicts_with = "flare")]
    slices: Vec<u32>,
    #[command(flatten)]
    pool: PoolFlags,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Ways of drawing that are timed.
fn ways(slices: &[u32]) -> Vec<(ReliefMode, SearchParameters)> {
    let usual = SearchParameters::default();
    let searches = slices.iter().map(|&slices| {
        let search = SearchParameters { slices, ..usual };
        (ReliefMode::Search, search)
    });
    [ReliefMode::Exact, ReliefMode::Polygons]
        .map(|mode| (mode, usual))
        .into_iter()
        .chain(searches)
        .collect()
}

/// Of the pixels that show a building in either of two images of ids, the part that shows another one or none in the other.
fn wrong_part(exact: &[u32], other: &[u32]) -> f64 {
    let either = exact.iter().zip(other).filter(|(a, b)| **a > 0 || **b > 0);
    let differ = either.clone().filter(|(a, b)| a != b).count();
    differ as f64 / either.count().max(1) as f64
}

/// Times the ways of drawing.
pub fn run(args: &BenchArgs) -> Result<(), CommandError> {
    let Some(folder) = &args.city else {
        return super::bench_flare::run(args.lens.as_deref(), args.size, args.frames, args.json);
    };
    let city = City::open(folder)?;
    let views = match &args.path {
        Some(path) => read_path(path, &city)?.keys,
        None => default_views(&city, args.size)?,
    };
    let gpu = Gpu::open().map_err(RenderError::from)?;
    let mut renderer = Renderer::open(gpu, &city, args.pool.options(TerrainMesh::Tin))?;
    let buildings = renderer.load_polygons(&city)?;
    let sun = sun(args.time.as_deref(), city.manifest().place)?;
    let lens = args.lens.as_deref().map(open).transpose()?.map(Arc::new);
    if let Some(lens) = &lens {
        require_f_number(lens, F_NUMBER)?;
    }
    let flare = lens
        .is_some()
        .then(|| FlareSettings::from_preset(Quality::High.preset(), Aperture::default()));
    let mut rows = Vec::new();
    for view in &views {
        let camera = match &lens {
            Some(lens) => Camera {
                pose: view.pose(),
                optics: Optics::Lens(LensOptics::new(Arc::clone(lens), F_NUMBER, FULL_FRAME_MM)),
            },
            None => Camera::pinhole(view.pose(), view.fov.unwrap_or(DEFAULT_FOV_DEG).to_radians()),
        };
        let projection = camera.projection(args.size);
        let in_view = buildings_in_view(&buildings, &projection);
        let mut exact_ids = Vec::new();
        for (mode, search) in ways(&args.slices) {
            let request = FrameRequest {
                camera: &camera,
                sun: &sun,
                size: args.size,
                relief: ReliefSettings {
                    mode,
                    search,
                    ..ReliefSettings::default()
                },
                flare: flare.as_ref(),
                exposure: 1.0,
            };
            let ids = renderer.still(&request, 1)?.ids;
            let times = frame_times(&mut renderer, &request, args.frames)?;
            let reads = reads_per_ray(&renderer.resident.tiles, &projection);
            let is_exact = mode == ReliefMode::Exact;
            let wrong = (!is_exact).then(|| wrong_part(&exact_ids, &ids));
            if is_exact {
                exact_ids = ids;
            }
            let pass = |name: &str| {
                let of_pass = |(_, passes): &FrameTime| {
                    passes.iter().find(|(known, _)| *known == name).map(|(_, ms)| *ms)
                };
                median(times.iter().filter_map(of_pass))
            };
            rows.push(json!({
                "view": view.name,
                "buildings_in_view": in_view,
                "relief": match mode {
                    ReliefMode::Exact => "exact".to_owned(),
                    ReliefMode::Polygons => "polygons".to_owned(),
                    ReliefMode::Search => format!("search {}", search.slices),
                },
                "wrong_percent": wrong.map(|part| 100.0 * part),
                "ground_ms": pass("ground"),
                "buildings_ms": pass("buildings"),
                "light_ms": pass("light"),
                "flare_ms": pass("flare"),
                "passes_ms": median(times.iter().map(|(_, passes)| passes.iter().map(|(_, ms)| ms).sum())),
                "wall_ms": median(times.iter().map(|(wall, _)| *wall)),
                "reads_per_ray": is_exact.then_some(reads.mean),
                "reads_per_ray_p99": is_exact.then_some(reads.p99),
                "resident_bytes": renderer.resident.bytes(),
                "resident_map_bytes": renderer.resident.map_bytes(),
            }));
        }
    }
    tell_warnings(&mut renderer);
    let report = json!({
        "device": renderer.gpu.adapter_name,
        "size": args.size,
        "frames": args.frames,
        "buildings": city.manifest().buildings,
        "resident_bytes": renderer.resident.bytes(),
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
        "{:10} {:>8} {:11} {:>10} {:>13} {:>10} {:>9} {:>8} {:>14} {:>6} {:>8}",
        "view",
        "in view",
        "relief",
        "ground ms",
        "buildings ms",
        "light ms",
        "passes ms",
        "wall ms",
        "reads per ray",
        "(p99)",
        "wrong %"
    );
    for row in report["views"].as_array().into_iter().flatten() {
        let number = |key: &str| {
            row[key]
                .as_f64()
                .map_or("-".to_owned(), |value| format!("{value:.1}"))
        };
        say!(
            "{:10} {:>8} {:11} {:>10} {:>13} {:>10} {:>9} {:>8} {:>14} {:>6} {:>8}",
            row["view"].as_str().unwrap_or(""),
            row["buildings_in_view"].as_u64().unwrap_or_default(),
            row["relief"].as_str().unwrap_or(""),
            number("ground_ms"),
            number("buildings_ms"),
            number("light_ms"),
            number("passes_ms"),
            number("wall_ms"),
            number("reads_per_ray"),
            number("reads_per_ray_p99"),
            number("wrong_percent")
        );
    }
}

/// Wall-clock milliseconds of a frame, and of its passes on the GPU.
type FrameTime = (f64, PassTimes);

/// Times frames without read-back; the first, which makes the targets, does not count.
fn frame_times(
    renderer: &mut Renderer,
    request: &FrameRequest<'_>,
    frames: u32,
) -> Result<Vec<FrameTime>, CommandError> {
    renderer.frame(request, 0)?;
    renderer.gpu.wait().map_err(RenderError::from)?;
    let mut times = Vec::new();
    for _ in 0..frames {
        let start = Instant::now();
        renderer.frame(request, 0)?;
        renderer.gpu.wait().map_err(RenderError::from)?;
        let wall_ms = start.elapsed().as_secs_f64() * 1e3;
        times.push((wall_ms, renderer.pass_times()?.unwrap_or_default()));
    }
    Ok(times)
}

/// Buildings of which at least a part may lie in the image, hidden ones too.
fn buildings_in_view(buildings: &[Building], projection: &Projection) -> usize {
    let frustum = Frustum::new(projection);
    let is_in_view =
        |building: &&Building| frustum.sees(&building.bounds(), building.base_m, building.roof_m);
    buildings.iter().filter(is_in_view).count()
}

/// Reads of the building map along rays of a view.
struct ReadsPerRay {
    mean: f64,
    /// Of a hundred rays ninety-nine read no more.
    p99: u32,
}

fn reads_per_ray(tiles: &TileSet, projection: &Projection) -> ReadsPerRay {
    const STRIDE: usize = 16;
    let eye = projection.pose.eye;
    let [width, height] = projection.size;
    let mut reads = Vec::new();
    for row in (0..height).step_by(STRIDE) {
        for column in (0..width).step_by(STRIDE) {
            let direction = projection.ray_direction(column, row);
            let (_, count) = cast_buildings(tiles, eye, direction, f32::INFINITY);
            reads.push(count);
        }
    }
    reads.sort_unstable();
    ReadsPerRay {
        mean: reads.iter().map(|&count| f64::from(count)).sum::<f64>() / reads.len().max(1) as f64,
        p99: reads.get(reads.len() * 99 / 100).copied().unwrap_or_default(),
    }
}
