//! Survey files to a city folder, tile by tile.
//!
//! ```text
//! footprints ──────────────┐
//! DTM ─▶ terrain ─▶ ground ─▶ footprint dataset (bases, roofs) ─▶ tiles ─▶ manifest
//! orthophotos, roads, water, green (ground_plan) ───────────────────┴▶ levels (each from the one below)
//! ```
//! The footprint source is read twice: for outlines and heights, and, when the ground has told which of them are
//! buildings, for their attributes, which are never held in memory.
//!
//! Memory: the footprints, 192 MiB of ground and a few tiles a thread. All cores. Everything goes to a staging
//! folder (`staging`), whose finished tiles a later run of the same import keeps.

mod clipped_ring;
mod dataset_of_record;
mod ground_plan;
mod levels;
mod options;
mod plan;
mod progress;
mod warnings;
mod sources;
mod spacing;
mod terrain;
mod tiles;

use dataset_of_record::make_footprint_dataset;
use ground_plan::GroundPlan;
use levels::{LevelParameters, make_levels};
use options::{cache_key, check_numbers, refuse_inputs_inside, source_files};
use plan::{Plan, rejected};
use progress::announce;
use sources::Sources;
use terrain::make_terrain;
use tiles::make_tiles;
use warnings::source_warnings;

pub use ground_plan::PlanFiles;
pub use options::{ImportOptions, Setting};
pub use progress::{ImportProgress, ImportStage};
pub use warnings::ImportWarning;

use std::collections::HashSet;
use std::path::Path;

use geo::CoordsIter;

use super::city_files::{MAX_TEXT, read_plain_text};
use super::durable::write;
use super::geotiff::GeoKeys;
use super::ground_cache::GroundCache;
use super::manifest::FORMAT;
use super::rules_file::{
    FACADES, FACADES_BEFORE, keep_pictures, pictures, read_rules, rules_from_city, write_pictures,
};
use super::staging::{Staging, changes_of};
use super::writer::TileWriter;
use super::{CityError, Manifest};
use crate::buildings::triangle_bytes;
use crate::material::FacadeRules;
use crate::source::{Footprint, HeightRule, require_sound};
use crate::space::{Crs, TileGrid};

/// Texels along a tile's side.
pub const TILE_TEXELS: usize = 512;

/// What an import did.
#[derive(Clone, Debug)]
pub struct ImportReport {
    /// The city as written.
    pub manifest: Manifest,
    /// Things the user should know.
    pub warnings: Vec<ImportWarning>,
    /// Terrain tiles with ground.
    pub terrain_tiles: u64,
    /// Samples filled in narrow holes.
    pub filled_samples: u64,
}

/// Number of tiles that a vertex of a footprint lies on.
fn built_tiles(grid: &TileGrid, footprints: &[Footprint]) -> usize {
    let vertices = footprints
        .iter()
        .flat_map(|footprint| footprint.outline.coords_iter());
    let tiles: HashSet<[i64; 2]> = vertices
        .map(|at| {
            [
                (at.x - grid.west) / grid.tile_m,
                (at.y - grid.south) / grid.tile_m,
            ]
            .map(|place| place.floor() as i64)
        })
        .collect();
    tiles.len()
}

/// Refuses a place where no folder can be, before the long work.
fn require_possible(out: &Path) -> Result<(), CityError> {
    let unfit = |why: &str| {
        Err(CityError::File {
            path: out.to_owned(),
            why: why.to_owned(),
        })
    };
    if out.to_str().is_none() {
        return unfit("its name is no UTF-8, which a GeoPackage's has to be; choose another");
    }
    if out.is_symlink() && !out.exists() {
        return unfit("is a link that leads nowhere; remove it, or choose another place");
    }
    if out.exists() && !out.is_dir() {
        return Err(CityError::Occupied { path: out.to_owned() });
    }
    match out.ancestors().skip(1).find(|folder| folder.exists()) {
        Some(folder) if !folder.is_dir() => unfit("lies under a file, not in a folder; choose another place"),
        _ => Ok(()),
    }
}

/// Makes a city.
pub fn import(options: &ImportOptions) -> Result<ImportReport, CityError> {
    check_numbers(options)?;
    require_possible(&options.out)?;
    for (_, file) in options.plan.all() {
        require_sound(file)?;
    }
    let mut warnings = Vec::new();
    let sources = Sources::open(options)?;
    if !Crs::is_plain_definition(sources.crs.label()) {
        return Err(CityError::UnfitCrs {
            crs: sources.crs.label().chars().take(80).collect(),
        });
    }
    let (rules, rules_text) = match &options.facades {
        Some(path) => read_rules(path)?,
        None => rules_from_city(&options.out)?,
    };
    let beside = match &options.facades {
        Some(path) => path.parent().unwrap_or(Path::new("")),
        None => &options.out,
    };
    let facade_pictures = pictures(beside, &rules)?;
    let files = source_files(options);
    refuse_inputs_inside(options, &files)?;
    let cache_key = cache_key(options, &rules_text, &files);
    let staging = Staging::open(&options.out, &cache_key.text)?;
    let folder = staging.folder();

    let rule = match &options.height_rule {
        Some(rule) => rule.clone(),
        None => sources.buildings.known_height_rule(options.storey_height_m)?,
    };
    if rule == HeightRule::Default {
        warnings.push(ImportWarning::NoHeights {
            default_height_m: options.default_height_m,
            fields: sources.buildings.field_names()?,
        });
    }
    let spinner = options.progress.count("footprints");
    let mut footprints: Vec<Footprint> = Vec::new();
    let default_height_m = options.default_height_m;
    let mut report = sources
        .buildings
        .read(&sources.crs, &rule, default_height_m, |footprint| {
            spinner.inc(1);
            footprints.push(footprint);
        })?;
    spinner.finish_and_clear();

    let plan = Plan::new(&sources, options, &footprints, &report)?;
    announce(
        &plan.grid,
        plan.terrain_side,
        built_tiles(&plan.grid, &footprints),
    );
    let keys = GeoKeys::from_crs(&sources.crs)?;
    let ground = GroundCache::new(
        folder.to_owned(),
        plan.grid,
        plan.terrain_side,
        plan.terrain_step_m,
    );
    let writer = TileWriter {
        folder,
        grid: plan.grid,
        terrain_side: plan.terrain_side,
        terrain_step_m: plan.terrain_step_m,
        keys: &keys,
    };
    let terrain = make_terrain(&sources, options, &plan, &writer, &ground)?;
    if terrain.tiles == 0 {
        return Err(CityError::NoGround {
            path: options.terrain[0].clone(),
        });
    }
    let dataset = folder.join("buildings.gpkg");
    let buildings = make_footprint_dataset(&sources, (footprints, &rules), &ground, &dataset, &mut report)?;
    if buildings.is_empty() {
        return Err(CityError::NoBuildings {
            path: options.buildings.clone(),
            rejected: rejected(&report),
        });
    }
    let ground_plan = GroundPlan::read(&options.plan, &sources.crs, plan.grid)?;
    let bar = options.progress.begin("tiles");
    let tiles = make_tiles((&sources, ground_plan.as_ref()), &plan, &buildings, &writer, &bar)?;
    let texel_m = plan.grid.tile_m / TILE_TEXELS as f64;
    let levels = LevelParameters {
        tile_texels: TILE_TEXELS,
        texel_m,
        imagery_side: tiles.imagery_side,
        terrain_error_m: options.terrain_error_m,
    };
    make_levels(&plan, &levels, &writer, &options.progress.begin("levels"))?;
    let place = sources.crs.place_of(plan.grid.bounds().centre())?;
    let bounds = plan.grid.bounds();
    warnings.extend(
        plan.fill_cut_m
            .map(|filled_m| ImportWarning::FillCut { filled_m }),
    );
    warnings.extend(source_warnings(&sources, options.keep_steps, &bounds, &place)?);
    let (operations, operation_warnings) = sources.operations()?;
    warnings.extend(operation_warnings.into_iter().map(ImportWarning::Operation));

    let manifest = Manifest {
        format: FORMAT,
        generation: 0,
        name: options
            .out
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .replace(char::is_control, " "),
        crs: sources.crs.label().to_owned(),
        units: "metre".to_owned(),
        texel_m,
        tile_texels: TILE_TEXELS,
        terrain_step_m: plan.terrain_step_m,
        terrain_side: plan.terrain_side,
        terrain_error_m: options.terrain_error_m,
        imagery_side: tiles.imagery_side,
        levels: plan.grid.levels(),
        terrain_tiles: terrain.tiles,
        building_tiles: tiles.buildings,
        imagery_tiles: tiles.imagery,
        buildings: buildings.len() as u64,
        dataset_changes: changes_of(&dataset),
        default_height_m: options.default_height_m,
        terrain_triangles: terrain.triangles,
        grid_triangles: terrain.grid_triangles,
        building_map_bytes: tiles.building_map_bytes,
        triangle_bytes: buildings
            .iter()
            .map(|building| triangle_bytes(&building.outline))
            .sum(),
        place,
        grid: plan.grid,
        height_rule: rule,
        sources: cache_key.records.clone(),
        operations,
        footprints: report,
    };
    let text = toml::to_string_pretty(&manifest).map_err(|error| CityError::File {
        path: folder.join("city.toml"),
        why: error.to_string(),
    })?;
    // What could not be opened again is told before it takes the old city's place.
    if let Err(why) = Manifest::from_text(&text) {
        return Err(CityError::NotACity {
            path: options.out.clone(),
            why,
        });
    }
    let path = folder.join(FACADES);
    write(&path, rules_text.as_bytes()).map_err(CityError::file(&path))?;
    let mut replaced = read_plain_text(&options.out.join(FACADES_BEFORE), MAX_TEXT).unwrap_or_default();
    let edited = rules_from_city(&options.out).map(|(_, text)| text);
    if let Some(edited) = edited
        .ok()
        .filter(|text| *text != rules_text && text != FacadeRules::BUILT_IN)
    {
        replaced = match replaced.is_empty() {
            true => edited,
            false => format!("{edited}\n# Before that:\n{replaced}"),
        };
    }
    if !replaced.is_empty() {
        let path = folder.join(FACADES_BEFORE);
        write(&path, replaced.as_bytes()).map_err(CityError::file(&path))?;
    }
    write_pictures(folder, &facade_pictures)?;
    keep_pictures(&options.out, folder)?;
    let path = folder.join("city.toml");
    write(&path, text.as_bytes()).map_err(CityError::file(&path))?;
    if let Some(path) = cache_key.changed_file() {
        return Err(CityError::SourceChanged {
            path: path.to_owned(),
        });
    }
    staging.finish()?;
    Ok(ImportReport {
        manifest,
        warnings,
        terrain_tiles: terrain.tiles,
        filled_samples: terrain.filled,
    })
}
