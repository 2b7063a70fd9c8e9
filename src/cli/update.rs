//! `rilievo update`: buildings of a finished city changed, added or taken out.

use std::path::PathBuf;

use serde_json::json;

use super::{CommandError, import_report};
use crate::city::{UpdateOptions, UpdateReport, update};

/// Flags of `update`.
#[derive(Debug, clap::Args)]
pub struct UpdateArgs {
    /// The city folder. Without --buildings and --delete its buildings.gpkg is taken as it is now: edit it in QGIS, then update.
    city: PathBuf,
    /// Footprints to add, or to put over those with the same fid: a GeoPackage, or any vector file with a column fid.
    #[arg(long)]
    buildings: Option<PathBuf>,
    /// Layer of that file.
    #[arg(long, requires = "buildings")]
    layer: Option<String>,
    /// CRS of that file, instead of what it says [default: the city's].
    #[arg(long, requires = "buildings")]
    buildings_crs: Option<String>,
    /// Ids (fid) of buildings to take out.
    #[arg(long, value_delimiter = ',', num_args = 1..)]
    delete: Vec<u32>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Updates and prints the report.
pub fn run(args: UpdateArgs) -> Result<(), CommandError> {
    let begun = std::time::Instant::now();
    let report = update(&UpdateOptions {
        city: args.city,
        buildings: args.buildings,
        layer: args.layer,
        crs: args.buildings_crs,
        delete: args.delete,
        known: None,
        replaces_attributes: false,
    })?;
    let milliseconds = begun.elapsed().as_secs_f64() * 1e3;
    if args.json {
        let [added, changed, deleted] = report.counts.map_or([None; 3], |counts| counts.map(Some));
        let object = json!({
            "generation": report.manifest.generation,
            "buildings": report.manifest.buildings,
            "added": added,
            "changed": changed,
            "deleted": deleted,
            "tiles_written": report.written,
            "tiles_removed": report.removed,
            "footprints": report.footprints,
            "ms": milliseconds,
        });
        say!("{object}");
    } else {
        print(&report, milliseconds);
    }
    Ok(())
}

fn print(report: &UpdateReport, milliseconds: f64) {
    if let Some([added, changed, deleted]) = report.counts {
        say!("  buildings        {added} added, {changed} changed, {deleted} deleted");
    }
    say!(
        "  city             {} buildings, generation {}",
        report.manifest.buildings,
        report.manifest.generation
    );
    say!(
        "  tiles            {} written, {} removed, in {milliseconds:.0} ms",
        report.written,
        report.removed
    );
    import_report::print_counts(&report.footprints);
}
