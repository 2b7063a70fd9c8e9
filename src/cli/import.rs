//! `rilievo import`: survey files to a city folder (`import_report` says what became of them).

use std::path::PathBuf;

use super::{CommandError, import_report};
use crate::city::{CityError, ImportOptions, ImportProgress, PlanFiles, import};
use crate::source::{GroundRules, HeightRule};

/// Flags of `import`.
#[derive(Debug, clap::Args)]
pub struct ImportArgs {
    /// Bare-earth terrain rasters (any format GDAL reads); several make a mosaic.
    #[arg(long, required = true, num_args = 1..)]
    terrain: Vec<PathBuf>,
    /// Building footprints (any format OGR reads, or CityJSON).
    #[arg(long)]
    buildings: PathBuf,
    /// Layer of the footprint file; for CAD drawings a CAD layer.
    #[arg(long)]
    layer: Option<String>,
    /// Field with the building's height above ground, metres [default: fields of known names, such as OSM's height and
    /// building:levels, BD TOPO's HAUTEUR, CityGML's measuredHeight].
    #[arg(long, group = "height")]
    height_field: Option<String>,
    /// Field with the number of storeys.
    #[arg(long, group = "height")]
    storeys_field: Option<String>,
    /// Height of a storey, metres.
    #[arg(long, default_value_t = ImportOptions::STOREY_HEIGHT_M)]
    storey_height: f64,
    /// Field with the roof's elevation above the vertical datum, metres.
    #[arg(long, group = "height")]
    roof_field: Option<String>,
    /// Height of buildings without one, metres.
    #[arg(long, default_value_t = ImportOptions::DEFAULT_HEIGHT_M)]
    default_height: f64,
    /// Orthophotos (any format GDAL reads); later ones lie on top.
    #[arg(long = "photo", num_args = 1..)]
    imagery: Vec<PathBuf>,
    /// Streets and paths (any vector format; of an OpenStreetMap file the highways), drawn on the ground where no orthophoto is.
    #[arg(long, num_args = 1..)]
    roads: Vec<PathBuf>,
    /// Railways, likewise.
    #[arg(long, num_args = 1..)]
    rails: Vec<PathBuf>,
    /// Rivers, lakes and the sea, likewise.
    #[arg(long, num_args = 1..)]
    water: Vec<PathBuf>,
    /// Parks, woods and fields, likewise.
    #[arg(long, num_args = 1..)]
    green: Vec<PathBuf>,
    /// The city's CRS, projected in metres [default: the terrain's, or the UTM zone of the place].
    #[arg(long)]
    crs: Option<String>,
    /// CRS of terrain files, instead of what they say [default: --crs].
    #[arg(long)]
    terrain_crs: Option<String>,
    /// CRS of a footprint file, instead of what they say [default: --crs].
    #[arg(long)]
    buildings_crs: Option<String>,
    /// CRS of orthophotos, instead of what they say [default: the city's].
    #[arg(long = "photo-crs")]
    imagery_crs: Option<String>,
    /// Metres per vertical unit of the terrain, 0.3048 for feet [default: what the files say].
    #[arg(long)]
    terrain_unit: Option<f64>,
    /// Keep terraces where the terrain's heights are stored in whole metres or other steps, instead of smoothing
    /// them within half a step.
    #[arg(long)]
    keep_steps: bool,
    /// Bound on the terrain mesh's vertical error, metres.
    #[arg(long, default_value_t = ImportOptions::TERRAIN_ERROR_M)]
    terrain_error: f64,
    /// Widest hole in the terrain that is filled, metres.
    #[arg(long, default_value_t = ImportOptions::FILL_M)]
    fill: f64,
    /// Terrain kept around the buildings, metres.
    #[arg(long, default_value_t = ImportOptions::MARGIN_M)]
    margin: f64,
    /// Side of a building-map texel, metres.
    #[arg(long, default_value_t = ImportOptions::TEXEL_M)]
    texel: f64,
    /// Rules for how roads, rails, water and green are drawn [default: the program's own, data/ground.toml].
    #[arg(long)]
    ground_rules: Option<PathBuf>,
    /// Rules that give buildings their facades and roofs [default: facades.toml of the city that is replaced, or the program's own;
    /// the city folder gets a copy to edit].
    #[arg(long)]
    facades: Option<PathBuf>,
    /// The city folder to make.
    #[arg(long)]
    out: PathBuf,
}

/// Imports and prints the report.
pub fn run(args: ImportArgs) -> Result<(), CommandError> {
    let storey_height_m = args.storey_height;
    let height_rule = (args.height_field.map(|field| HeightRule::Height { field }))
        .or_else(|| {
            args.storeys_field.map(|field| HeightRule::Storeys {
                field,
                storey_height_m,
            })
        })
        .or_else(|| args.roof_field.map(|field| HeightRule::RoofElevation { field }));
    let rules = args.ground_rules.as_deref().map(GroundRules::read).transpose();
    let rules = rules.map_err(CityError::from)?.unwrap_or_default();
    let options = ImportOptions {
        terrain: args.terrain,
        buildings: args.buildings,
        layer: args.layer,
        height_rule,
        storey_height_m,
        default_height_m: args.default_height,
        imagery: args.imagery,
        crs: args.crs,
        terrain_crs: args.terrain_crs,
        buildings_crs: args.buildings_crs,
        imagery_crs: args.imagery_crs,
        terrain_unit_m: args.terrain_unit,
        keep_steps: args.keep_steps,
        terrain_error_m: args.terrain_error,
        fill_m: args.fill,
        margin_m: args.margin,
        texel_m: args.texel,
        plan: PlanFiles {
            roads: args.roads,
            rails: args.rails,
            water: args.water,
            green: args.green,
            rules,
        },
        facades: args.facades,
        out: args.out,
        progress: ImportProgress::default(),
    };
    let report = import(&options)?;
    import_report::print(&options, &report);
    Ok(())
}
