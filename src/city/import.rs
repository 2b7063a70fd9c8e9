//! Survey files to a city folder, tile by tile.
//!
//! ```text
//! footprints ─▶ digital map ─┐
//! DTM ─▶ terrain tiles ─▶ bases ─▶ building-map tiles ─▶ manifest
//! photos ─▶ photo tiles ───────────────────────────────────┘
//! ```
//! Memory: the footprints, 192 MiB of ground and a few tiles a thread. All cores. Everything goes to a staging
//! folder (`staging`), whose finished tiles a later run of the same import keeps.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use glam::DVec2;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::codec::{self, PhotoTile, TerrainTile};
use super::geotiff::GeoKeys;
use super::ground::Ground;
use super::manifest::FORMAT;
use super::staging::Staging;
use super::store::{Layer, tile_path};
use super::{CityError, Manifest, SourceRecord};
use crate::buildings::{Building, rasterise, triangle_bytes};
use crate::source::{
    CrsChoice, Dtm, Footprint, FootprintReport, FootprintSource, HeightRule, MapWriter, Photos,
};
use crate::space::{Bounds, Crs, TileGrid, TileId};
use crate::terrain::{Apron, HeightTile, fill_gaps, grid_triangles, tin_triangles};

/// Texels along a tile's side.
pub const TILE_TEXELS: usize = 512;

/// What `rilievo import` was asked.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ImportOptions {
    /// Terrain rasters.
    pub terrain: Vec<PathBuf>,
    /// Footprint file.
    pub buildings: PathBuf,
    /// Its layer.
    pub layer: Option<String>,
    /// Which attribute gives heights; none = what the format itself knows.
    pub height_rule: Option<HeightRule>,
    /// Height of buildings without one, metres.
    pub default_height_m: f64,
    /// Aerial photos.
    pub photos: Vec<PathBuf>,
    /// The city's CRS; none = the terrain's if it will do, else the UTM zone.
    pub crs: Option<String>,
    /// CRS of terrain files that name none.
    pub terrain_crs: Option<String>,
    /// CRS of a footprint file that names none.
    pub buildings_crs: Option<String>,
    /// CRS of photos that name none.
    pub photo_crs: Option<String>,
    /// Metres per vertical unit of the terrain; none = what the files say.
    pub terrain_unit_m: Option<f64>,
    /// Bound on the terrain mesh's error, metres.
    pub terrain_error_m: f64,
    /// Widest hole in the terrain that is filled, metres.
    pub fill_m: f64,
    /// Terrain kept around the buildings, metres.
    pub margin_m: f64,
    /// Side of a building-map texel, metres.
    pub texel_m: f64,
    /// The city folder to make.
    pub out: PathBuf,
}

/// What an import did.
#[derive(Clone, Debug)]
pub struct ImportReport {
    /// The city as written.
    pub manifest: Manifest,
    /// Things the user should know, each with what to do.
    pub warnings: Vec<String>,
    /// Terrain tiles with ground.
    pub terrain_tiles: u64,
    /// Samples filled in narrow holes.
    pub filled_samples: u64,
}

/// Makes a city.
pub fn import(options: &ImportOptions) -> Result<ImportReport, CityError> {
    check_numbers(options)?;
    let mut warnings = Vec::new();
    let sources = Sources::open(options)?;
    let recipe = recipe(options)?;
    refuse_inputs_inside(options)?;
    let staging = Staging::open(&options.out, &recipe.text)?;
    let folder = staging.folder();

    let rule = match &options.height_rule {
        Some(rule) => rule.clone(),
        None => sources.buildings.default_rule(),
    };
    if rule == HeightRule::Default {
        let fields = sources.buildings.field_names()?;
        warnings.push(format!(
            "no height field named: every building is {} m high; choose one with --height-field, --storeys-field or --roof-field (the file's fields: {})",
            options.default_height_m,
            fields.join(", ")
        ));
    }
    let mut map = MapWriter::create(&folder.join("buildings.gpkg"), &sources.crs)?;
    let spinner = progress("footprints", 0);
    let mut footprints: Vec<Footprint> = Vec::new();
    let mut report = sources.buildings.read(
        &sources.crs,
        &rule,
        options.default_height_m,
        Some(&mut map),
        |footprint| {
            spinner.inc(1);
            footprints.push(footprint);
        },
    )?;
    spinner.finish_and_clear();

    let plan = Plan::new(&sources, options, &footprints, &report)?;
    let keys = GeoKeys::of(&sources.crs)?;
    let ground = Ground::new(
        folder.to_owned(),
        plan.grid,
        plan.terrain_side,
        plan.terrain_step_m,
    );
    let terrain = make_terrain(&sources, options, &plan, folder, &keys, &ground)?;
    if terrain.tiles == 0 {
        return Err(CityError::Unfit {
            what: format!(
                "{}: has no ground where the buildings are",
                options.terrain[0].display()
            ),
            advice: "check that both files show the same place".to_owned(),
        });
    }
    let buildings = stand_on_ground(footprints, &ground, &mut report, &mut map)?;
    if buildings.is_empty() {
        return Err(CityError::Unfit {
            what: format!(
                "{}: no footprint could be kept ({} read{})",
                options.buildings.display(),
                report.read,
                left_out(&report)
            ),
            advice: "check the layer (--layer) and that it shows the same place as the terrain".to_owned(),
        });
    }
    let (building_map_bytes, building_tiles) = make_building_maps(&buildings, &plan, folder, &keys)?;
    let (photo_side, photo_tiles) = make_photos(&sources, &plan, folder, &keys)?;
    if photo_tiles == 0 && !options.photos.is_empty() {
        warnings.push("no photo lies on the city: check the photos' place and --photo-crs".to_owned());
    }
    map.finish()?;

    let manifest = Manifest {
        format: FORMAT,
        name: options
            .out
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned(),
        crs: sources.crs.label().to_owned(),
        units: "metre".to_owned(),
        texel_m: plan.grid.tile_m / TILE_TEXELS as f64,
        tile_texels: TILE_TEXELS,
        terrain_step_m: plan.terrain_step_m,
        terrain_side: plan.terrain_side,
        terrain_error_m: options.terrain_error_m,
        photo_side,
        levels: 1,
        terrain_tiles: terrain.tiles,
        building_tiles,
        photo_tiles,
        buildings: buildings.len() as u64,
        default_height_m: options.default_height_m,
        terrain_triangles: terrain.triangles,
        grid_triangles: terrain.grid_triangles,
        building_map_bytes,
        triangle_bytes: buildings
            .iter()
            .map(|building| triangle_bytes(&building.outline))
            .sum(),
        place: sources.crs.place_of(plan.grid.bounds().centre())?,
        grid: plan.grid,
        height_rule: rule,
        sources: recipe.records,
        footprints: report,
    };
    let text = toml::to_string_pretty(&manifest).map_err(|error| CityError::File {
        path: folder.join("city.toml"),
        why: error.to_string(),
    })?;
    let path = folder.join("city.toml");
    std::fs::write(&path, text).map_err(CityError::file(&path))?;
    staging.finish()?;
    Ok(ImportReport {
        manifest,
        warnings,
        terrain_tiles: terrain.tiles,
        filled_samples: terrain.filled,
    })
}

/// The old city is replaced whole: a source inside it would be lost.
fn refuse_inputs_inside(options: &ImportOptions) -> Result<(), CityError> {
    let Ok(out) = std::fs::canonicalize(&options.out) else {
        return Ok(());
    };
    let inputs = options
        .terrain
        .iter()
        .chain([&options.buildings])
        .chain(&options.photos);
    for input in inputs {
        if std::fs::canonicalize(input).is_ok_and(|input| input.starts_with(&out)) {
            return Err(CityError::Unfit {
                what: format!(
                    "{}: lies inside --out, which the import replaces",
                    input.display()
                ),
                advice: "copy it elsewhere first, or choose another --out".to_owned(),
            });
        }
    }
    Ok(())
}

fn check_numbers(options: &ImportOptions) -> Result<(), CityError> {
    let storey_height_m = match options.height_rule {
        Some(HeightRule::Storeys { storey_height_m, .. }) => storey_height_m,
        _ => 3.0,
    };
    for (flag, value, range) in [
        ("--texel", options.texel_m, 0.1..=64.0),
        ("--terrain-error", options.terrain_error_m, 0.001..=1000.0),
        ("--default-height", options.default_height_m, 0.01..=2000.0),
        ("--fill", options.fill_m, 0.0..=10_000.0),
        ("--margin", options.margin_m, 0.0..=1_000_000.0),
        (
            "--terrain-unit",
            options.terrain_unit_m.unwrap_or(1.0),
            0.001..=1000.0,
        ),
        ("--storey-height", storey_height_m, 0.5..=50.0),
    ] {
        if !range.contains(&value) {
            return Err(CityError::Unfit {
                what: format!("{flag} {value} is out of range"),
                advice: format!("give a value from {} to {}", range.start(), range.end()),
            });
        }
    }
    Ok(())
}

struct Sources {
    dtm: Dtm,
    buildings: FootprintSource,
    photos: Option<Photos>,
    crs: Crs,
}

impl Sources {
    fn open(options: &ImportOptions) -> Result<Self, CityError> {
        let parse = |text: &Option<String>| text.as_deref().map(Crs::from_text).transpose();
        let city = parse(&options.crs)?;
        let terrain_crs = CrsChoice::new(parse(&options.terrain_crs)?, city.as_ref());
        let dtm = Dtm::open(&options.terrain, &terrain_crs, options.terrain_unit_m)?;
        let buildings_crs = CrsChoice::new(parse(&options.buildings_crs)?, city.as_ref());
        let buildings = FootprintSource::open(&options.buildings, options.layer.as_deref(), &buildings_crs)?;
        let crs = match city {
            Some(crs) => {
                crs.require_metric()?;
                crs
            }
            None if dtm.crs().is_metric()? => dtm.crs().clone(),
            None => {
                let centre = match buildings.centre_on_globe() {
                    Some(centre) => centre,
                    None => dtm.centre_on_globe()?,
                };
                Crs::utm_of(centre.x, centre.y)?
            }
        };
        let photo_crs = CrsChoice::new(parse(&options.photo_crs)?, Some(&crs));
        let photos = (!options.photos.is_empty())
            .then(|| Photos::open(&options.photos, &photo_crs, &crs))
            .transpose()?;
        Ok(Self {
            dtm,
            buildings,
            photos,
            crs,
        })
    }
}

struct Recipe {
    text: String,
    records: Vec<SourceRecord>,
}

/// The options and every source's size and time: an import with the same recipe makes the same tiles.
fn recipe(options: &ImportOptions) -> Result<Recipe, CityError> {
    let mut records = Vec::new();
    let mut text = format!("rilievo {}\n", env!("CARGO_PKG_VERSION"));
    text += &serde_json::to_string(options).unwrap_or_default();
    let roles = [
        ("terrain", options.terrain.as_slice()),
        ("buildings", std::slice::from_ref(&options.buildings)),
        ("photo", options.photos.as_slice()),
    ];
    for (role, path) in roles
        .iter()
        .flat_map(|(role, paths)| paths.iter().map(move |path| (role, path)))
    {
        let (bytes, modified) = match std::fs::metadata(path) {
            Ok(data) => (data.len(), data.modified().ok()),
            Err(_) => (0, None), // GDAL's own names, such as /vsizip/..
        };
        text += &format!("\n{role} {} {bytes} {modified:?}", path.display());
        records.push(SourceRecord {
            role: (*role).to_owned(),
            path: path.display().to_string(),
            bytes,
        });
    }
    Ok(Recipe { text, records })
}

/// The tile grid and the terrain's lattice.
struct Plan {
    grid: TileGrid,
    terrain_side: usize,
    terrain_step_m: f64,
    /// Longest run of missing samples that is filled.
    fill_samples: usize,
}

/// Distance between terrain samples at most, metres: the bilinear surface bends at the file's pixel centres, and where
/// samples cannot lie on those, a coarse lattice would cut the bends off (by a quarter of the step times the bend).
const MOST_STEP_M: f64 = 4.0;

/// Samples that a file's pixel gets at least, where its own cannot be used.
const SAMPLES_PER_PIXEL: f64 = 4.0;

/// Most intervals along a tile's side.
const MOST_INTERVALS: f64 = 1024.0;

/// Most tiles of a city.
const MOST_TILES: f64 = 1e6;

impl Plan {
    fn new(
        sources: &Sources,
        options: &ImportOptions,
        footprints: &[Footprint],
        report: &FootprintReport,
    ) -> Result<Self, CityError> {
        let terrain = sources.dtm.bounds_in(&sources.crs)?;
        let (mut built, mut all) = (Bounds::EMPTY, Bounds::EMPTY);
        for footprint in footprints {
            let bounds = outline_bounds(footprint);
            all = all.union(&bounds);
            if bounds.meets(&terrain) {
                built = built.union(&bounds);
            }
        }
        let bounds = built.grown(options.margin_m).intersection(&terrain);
        if bounds.is_empty() {
            return Err(CityError::Unfit {
                what: format!(
                    "{}: no footprint lies on the terrain (terrain: {}; footprints: {}; {} read{})",
                    options.buildings.display(),
                    describe(&terrain),
                    describe(&all),
                    report.read,
                    left_out(report)
                ),
                advice: "check the files' coordinate reference systems (--buildings-crs, --terrain-crs)"
                    .to_owned(),
            });
        }
        let tile_m = options.texel_m * TILE_TEXELS as f64;
        let tiles = (bounds.width() / tile_m + 1.0) * (bounds.height() / tile_m + 1.0);
        if tiles > MOST_TILES {
            return Err(CityError::Unfit {
                what: format!("the city would have {tiles:.0} tiles ({})", describe(&bounds)),
                advice: "use larger texels (--texel) or a smaller --margin".to_owned(),
            });
        }
        if let Some((anchor, pixel_m)) = sources.dtm.lattice_in(&sources.crs)
            && let Some(plan) = Self::on_pixels(&bounds, tile_m, anchor, pixel_m, options.fill_m)
        {
            return Ok(plan);
        }
        let wanted = (sources.dtm.finest_pixel_m() / SAMPLES_PER_PIXEL)
            .min(MOST_STEP_M)
            .max(0.5 * options.texel_m);
        let mut intervals = 16;
        while tile_m / intervals as f64 > wanted && (intervals as f64) < MOST_INTERVALS {
            intervals *= 2;
        }
        // Bilinear needs both neighbours, so a hole of w metres is w + a pixel wide here.
        let fill_m = options.fill_m + sources.dtm.coarsest_pixel_m();
        let grid = TileGrid::covering(&bounds, tile_m, DVec2::ZERO, options.texel_m);
        let terrain_step_m = tile_m / intervals as f64;
        Ok(Self {
            grid,
            terrain_side: intervals + 1,
            terrain_step_m,
            fill_samples: if options.fill_m > 0.0 {
                (fill_m / terrain_step_m) as usize
            } else {
                0
            },
        })
    }

    /// Terrain samples on the file's own pixel centres (and whole fractions between), so that the city's ground is the
    /// file's to the last bit. The tile's side becomes the nearest whole number of pixels, and the texel follows it.
    fn on_pixels(bounds: &Bounds, tile_m: f64, anchor: DVec2, pixel_m: f64, fill_m: f64) -> Option<Self> {
        let pixels = (tile_m / pixel_m).round();
        let parts = (pixel_m / MOST_STEP_M).ceil().max(1.0);
        let side_m = pixels * pixel_m;
        let near_enough = (side_m / tile_m - 1.0).abs() < 0.25;
        // A hole is as wide as its pixels, and missing up to the known centres on both sides of it.
        let hole_samples = (fill_m / pixel_m).floor() * parts + parts - 1.0;
        (near_enough && pixels * parts <= MOST_INTERVALS).then(|| Self {
            grid: TileGrid::covering(bounds, side_m, anchor, pixel_m),
            terrain_side: (pixels * parts) as usize + 1,
            terrain_step_m: pixel_m / parts,
            fill_samples: if fill_m >= pixel_m {
                hole_samples as usize
            } else {
                0
            },
        })
    }
}

fn outline_bounds(footprint: &Footprint) -> Bounds {
    use geo::CoordsIter;
    let mut bounds = Bounds::EMPTY;
    for point in footprint.outline.exterior_coords_iter() {
        bounds.include(point.x, point.y);
    }
    bounds
}

/// Why features became no building, for a message.
fn left_out(report: &FootprintReport) -> String {
    let reasons = report.left_out.iter();
    reasons
        .map(|(why, count)| format!(", {count} left out: {why}"))
        .collect()
}

fn describe(bounds: &Bounds) -> String {
    if bounds.is_empty() {
        return "none".to_owned();
    }
    format!(
        "{:.0} to {:.0} east, {:.0} to {:.0} north",
        bounds.west, bounds.east, bounds.south, bounds.north
    )
}

fn progress(what: &'static str, total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total);
    let template = if total > 0 {
        "{prefix:12} {wide_bar} {pos}/{len} {eta}"
    } else {
        "{prefix:12} {pos}"
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_prefix(what);
    bar
}

struct TerrainTotals {
    tiles: u64,
    triangles: u64,
    grid_triangles: u64,
    filled: u64,
}

fn make_terrain(
    sources: &Sources,
    options: &ImportOptions,
    plan: &Plan,
    folder: &Path,
    keys: &GeoKeys,
    ground: &Ground,
) -> Result<TerrainTotals, CityError> {
    let tiles: Vec<TileId> = plan.grid.tiles().collect();
    let bar = progress("terrain", tiles.len() as u64);
    let totals = [const { AtomicU64::new(0) }; 4];
    let (dtm, crs) = (&sources.dtm, &sources.crs);
    tiles
        .par_iter()
        .with_min_len(4)
        .map_init(
            || dtm.sampler(crs),
            |sampler, &id| -> Result<(), CityError> {
                let path = tile_path(folder, Layer::Terrain, id);
                // A tile that an interrupted import left unreadable is made again.
                let left = path
                    .exists()
                    .then(|| codec::read_terrain(&path, plan.terrain_side, plan.terrain_step_m).ok())
                    .flatten();
                let tile = if left.is_some() {
                    left
                } else {
                    let sampler = match sampler {
                        Ok(sampler) => sampler,
                        Err(_) => &mut dtm.sampler(crs)?,
                    };
                    let (tile, filled) = terrain_tile(sampler, plan, id, options.terrain_error_m)?;
                    totals[3].fetch_add(filled, Ordering::Relaxed);
                    if let Some(tile) = &tile {
                        codec::write_terrain(&path, &plan.grid.tile_bounds(id), tile, keys)?;
                    }
                    tile
                };
                if let Some(tile) = &tile {
                    totals[0].fetch_add(1, Ordering::Relaxed);
                    totals[1].fetch_add(tile.triangles.len() as u64, Ordering::Relaxed);
                    totals[2].fetch_add(grid_triangles(&tile.ground).len() as u64, Ordering::Relaxed);
                }
                ground.keep(id, tile.map(|tile| Arc::new(tile.ground)));
                bar.inc(1);
                Ok(())
            },
        )
        .collect::<Result<(), _>>()?;
    bar.finish_and_clear();
    let [tiles, triangles, grid_triangles, filled] = totals.map(AtomicU64::into_inner);
    Ok(TerrainTotals {
        tiles,
        triangles,
        grid_triangles,
        filled,
    })
}

/// Samples, fills and tessellates one tile; none where there is no ground. Beside it the samples filled.
fn terrain_tile(
    sampler: &mut crate::source::DtmSampler,
    plan: &Plan,
    id: TileId,
    tolerance_m: f64,
) -> Result<(Option<TerrainTile>, u64), CityError> {
    let side = plan.terrain_side;
    let intervals = side as i64 - 1;
    let corner = DVec2::new(plan.grid.west, plan.grid.south);
    let first = [i64::from(id.x) * intervals, i64::from(id.y) * intervals];
    let lattice = |sampler: &mut crate::source::DtmSampler, margin: usize| {
        let first = first.map(|index| index - margin as i64);
        sampler.lattice(corner, plan.terrain_step_m, first, [side + 2 * margin; 2])
    };
    let mut apron = lattice(sampler, 1)?;
    let missing = |heights: &[f32]| heights.iter().filter(|height| !height.is_finite()).count() as u64;
    let mut filled = 0;
    if missing(&apron) > 0 && plan.fill_samples > 0 {
        let margin = plan.fill_samples + 2;
        let wide_side = side + 2 * margin;
        let mut wide = lattice(sampler, margin)?;
        fill_gaps(&mut wide, [wide_side; 2], plan.fill_samples);
        let before = missing(&apron);
        apron = cut(&wide, wide_side, margin - 1, side + 2);
        filled = before - missing(&apron);
    }
    let ground = HeightTile {
        side,
        step_m: plan.terrain_step_m,
        heights: cut(&apron, side + 2, 1, side),
    };
    if ground.range().is_none() {
        return Ok((None, filled));
    }
    let triangles = tin_triangles(&ground, &Apron(&apron), tolerance_m as f32);
    let tile = (!triangles.is_empty()).then_some(TerrainTile { ground, triangles });
    Ok((tile, filled))
}

/// The square of `side` samples that starts `margin` in from the corner.
fn cut(heights: &[f32], wide: usize, margin: usize, side: usize) -> Vec<f32> {
    (0..side)
        .flat_map(|row| {
            let start = (row + margin) * wide + margin;
            heights[start..start + side].iter().copied()
        })
        .collect()
}

fn stand_on_ground(
    footprints: Vec<Footprint>,
    ground: &Ground,
    report: &mut FootprintReport,
    map: &mut MapWriter,
) -> Result<Vec<Building>, CityError> {
    let failure: Mutex<Option<CityError>> = Mutex::new(None);
    let standing: Vec<Result<(Building, bool, Option<&'static str>), u32>> = footprints
        .into_par_iter()
        .map(|footprint| {
            let (fid, default_height) = (footprint.fid, footprint.default_height);
            Building::on_ground(footprint, |x, y| {
                ground.at(x, y).unwrap_or_else(|error| {
                    let mut failure = failure.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                    failure.get_or_insert(error);
                    None
                })
            })
            .map(|(building, partly_missing)| (building, partly_missing, default_height))
            .map_err(|_| fid)
        })
        .collect();
    if let Some(error) = failure
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
    {
        return Err(error);
    }
    let mut buildings = Vec::with_capacity(standing.len());
    let mut groundless = Vec::new();
    for result in standing {
        match result {
            Ok((building, partly_missing, default_height)) => {
                if partly_missing {
                    report.mend("partly over missing ground: stands on what there is");
                }
                if let Some(why) = default_height {
                    report.default_height(why);
                }
                buildings.push(building);
            }
            Err(fid) => {
                report.leave_out_kept("no ground under it");
                groundless.push(fid);
            }
        }
    }
    map.remove(&groundless)?;
    buildings.sort_by_key(|building| building.fid);
    Ok(buildings)
}

/// Rasterises every tile a building touches; returns the map's bytes when loaded.
fn make_building_maps(
    buildings: &[Building],
    plan: &Plan,
    folder: &Path,
    keys: &GeoKeys,
) -> Result<(u64, u64), CityError> {
    let mut by_tile: BTreeMap<TileId, Vec<&Building>> = BTreeMap::new();
    for building in buildings {
        for tile in plan.grid.tiles_meeting(&building.bounds()) {
            by_tile.entry(tile).or_default().push(building);
        }
    }
    let tiles: Vec<(TileId, Vec<&Building>)> = by_tile.into_iter().collect();
    let bar = progress("buildings", tiles.len() as u64);
    let (bytes, written) = (AtomicU64::new(0), AtomicU64::new(0));
    tiles
        .par_iter()
        .map(|(id, buildings)| -> Result<(), CityError> {
            let path = tile_path(folder, Layer::Buildings, *id);
            let bounds = plan.grid.tile_bounds(*id);
            let map = rasterise(&bounds, TILE_TEXELS, buildings).map_err(|error| CityError::Tile {
                path: path.clone(),
                why: error.to_string(),
            })?;
            if map.vertices.is_empty() && map.cells.iter().all(|&word| word == 0) {
                return Ok(()); // only its rectangle touches the tile
            }
            written.fetch_add(1, Ordering::Relaxed);
            bytes.fetch_add((map.bytes() + map.cells.len() * 4 / 3) as u64, Ordering::Relaxed);
            let left = codec::read_buildings(&path, TILE_TEXELS, f64::from(map.texel_m));
            if left.is_err() {
                codec::write_buildings(&path, &bounds, &map, keys)?;
            }
            bar.inc(1);
            Ok(())
        })
        .collect::<Result<(), _>>()?;
    bar.finish_and_clear();
    Ok((bytes.into_inner(), written.into_inner()))
}

/// Most photo pixels along a tile's side.
const MOST_PHOTO_PIXELS: usize = 1024;

/// Warps the photos tile by tile; returns the pixels along a side, 0 without photos.
fn make_photos(
    sources: &Sources,
    plan: &Plan,
    folder: &Path,
    keys: &GeoKeys,
) -> Result<(usize, u64), CityError> {
    let Some(photos) = &sources.photos else {
        return Ok((0, 0));
    };
    let mut side = 64;
    while side < MOST_PHOTO_PIXELS && plan.grid.tile_m / side as f64 > 1.01 * photos.finest_pixel_m() {
        side *= 2;
    }
    let crs = &sources.crs;
    let tiles: Vec<TileId> = plan
        .grid
        .tiles()
        .filter(|&id| photos.meet(&plan.grid.tile_bounds(id)))
        .collect();
    let bar = progress("photos", tiles.len() as u64);
    let written = AtomicU64::new(0);
    tiles
        .par_iter()
        .map(|&id| -> Result<(), CityError> {
            let path = tile_path(folder, Layer::Photo, id);
            if codec::read_photo(&path, side).is_err() {
                let bounds = plan.grid.tile_bounds(id);
                let rgba = photos.warp(crs, &bounds, side)?;
                if rgba.chunks_exact(4).all(|pixel| pixel[3] == 0) {
                    return Ok(());
                }
                {
                    codec::write_photo(&path, &bounds, &PhotoTile { side, rgba }, keys)?;
                }
            }
            bar.inc(1);
            Ok(())
        })
        .collect::<Result<(), _>>()?;
    bar.finish_and_clear();
    Ok((side, written.into_inner()))
}
