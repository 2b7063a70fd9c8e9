//! `rilievo info`: what a city holds.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::CommandError;
use crate::city::{City, Layer};
use crate::space::Crs;

/// Flags of `info`.
#[derive(Debug, clap::Args)]
pub struct InfoArgs {
    /// The city folder.
    pub city: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
}

/// Prints the city's figures.
pub fn run(args: &InfoArgs) -> Result<(), CommandError> {
    let city = City::open(&args.city)?;
    let manifest = city.manifest();
    let bounds = manifest.grid.bounds();
    let square_km = bounds.width() * bounds.height() * 1e-6;
    let per_building = |bytes: u64| bytes as f64 / manifest.buildings.max(1) as f64;
    let per_km2 = |bytes: u64| bytes as f64 / square_km;
    let on_disk = Layer::ALL.map(|layer| (layer.name(), bytes_under(&args.city.join(layer.name()))));
    if args.json {
        let object = json!({
            "name": manifest.name,
            "crs": manifest.crs,
            "buildings": manifest.buildings,
            "tiles": u64::from(manifest.grid.columns) * u64::from(manifest.grid.rows),
            "extent": [bounds.west, bounds.south, bounds.east, bounds.north],
            "texel_m": manifest.texel_m,
            "terrain_step_m": manifest.terrain_step_m,
            "terrain_error_m": manifest.terrain_error_m,
            "levels": manifest.levels,
            "bytes_on_disk": on_disk.into_iter().collect::<BTreeMap<_, _>>(),
            "building_map_bytes": manifest.building_map_bytes,
            "building_map_bytes_per_km2": per_km2(manifest.building_map_bytes),
            "building_map_bytes_per_building": per_building(manifest.building_map_bytes),
            "triangle_bytes": manifest.triangle_bytes,
            "triangle_bytes_per_building": per_building(manifest.triangle_bytes),
            "terrain_triangles": manifest.terrain_triangles,
            "grid_triangles": manifest.grid_triangles,
            "place": manifest.place,
            "operations": manifest.operations,
            "footprints": manifest.footprints,
        });
        say!("{object}");
        return Ok(());
    }
    say!("{}", manifest.name);
    say!("  CRS            {}", Crs::short_label(&manifest.crs));
    for record in &manifest.operations {
        let from = Crs::short_label(&record.from);
        match record.operation.as_str() {
            "none" => say!("  {:13}  in the city's CRS", record.role),
            operation => say!(
                "  {:13}  from {from}, {}: {operation}",
                record.role,
                record.accuracy()
            ),
        }
    }
    say!(
        "  extent         {:.1} {:.1} {:.1} {:.1} (west south east north, {square_km:.2} km2)",
        bounds.west,
        bounds.south,
        bounds.east,
        bounds.north
    );
    say!("  buildings      {}", manifest.buildings);
    say!(
        "  heights        {}",
        super::import_report::heights(&manifest.footprints)
    );
    say!(
        "  tiles          {} x {} of {} m",
        manifest.grid.columns,
        manifest.grid.rows,
        manifest.grid.tile_m
    );
    say!(
        "  terrain        {} triangles within {} m (a regular grid: {})",
        manifest.terrain_triangles,
        manifest.terrain_error_m,
        manifest.grid_triangles
    );
    let megabytes = |bytes: u64| format!("{:.2} MB", bytes as f64 * 1e-6);
    say!(
        "  on disk        {}, in {} levels",
        on_disk
            .map(|(name, bytes)| format!("{name} {}", megabytes(bytes)))
            .join(", "),
        manifest.levels
    );
    say!("  on the device");
    for (what, bytes) in [
        ("building map ", manifest.building_map_bytes),
        ("as triangles ", manifest.triangle_bytes),
    ] {
        say!(
            "  {what}  {:.2} MB: {:.0} bytes a building, {:.0} kB/km2",
            bytes as f64 * 1e-6,
            per_building(bytes),
            per_km2(bytes) * 1e-3
        );
    }
    Ok(())
}

/// Bytes of all files under a folder.
fn bytes_under(folder: &Path) -> u64 {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return 0;
    };
    let bytes = |entry: std::fs::DirEntry| match entry.metadata() {
        Ok(data) if data.is_dir() => bytes_under(&entry.path()),
        Ok(data) => data.len(),
        Err(_) => 0,
    };
    entries.flatten().map(bytes).sum()
}
