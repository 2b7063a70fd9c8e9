//! What `rilievo import` says of a city that it made.

use std::collections::BTreeMap;

use super::advice;
use crate::city::{ImportOptions, ImportReport, ImportWarning};
use crate::source::{FieldCount, FootprintReport, listed};
use crate::space::Crs;

/// Columns of a line that holds a list.
const LINE: usize = 100;

/// Prints the report.
pub fn print(options: &ImportOptions, report: &ImportReport) {
    let city = &report.manifest;
    let footprints = &city.footprints;
    say!("{}", options.out.display());
    say!("  CRS              {}", Crs::short_label(&city.crs));
    say!(
        "  terrain          {} tiles of {} m, samples {} m apart, {} triangles (grid: {}), {} samples filled",
        report.terrain_tiles,
        city.grid.tile_m,
        city.terrain_step_m,
        city.terrain_triangles,
        city.grid_triangles,
        report.filled_samples
    );
    print_counts(footprints);
    for warning in &report.warnings {
        say!("  note: {warning}; {}", advice::for_warning(warning));
        if let ImportWarning::NoHeights { fields, .. } = warning {
            let fields = format!("the file's fields: {}", listed(fields));
            for line in textwrap::wrap(&fields, LINE - 8) {
                say!("        {line}");
            }
        }
    }
}

/// Prints what became of footprints.
pub fn print_counts(footprints: &FootprintReport) {
    say!("  footprints read  {}", footprints.read);
    say!("  kept             {}", footprints.kept);
    say!("  heights          {}", heights(footprints));
    counted("repaired", &footprints.repaired);
    counted("rejected", &footprints.rejected);
    counted("default height", &footprints.default_heights);
    for field in footprints.heights.iter().filter(|field| field.unusable > 0) {
        let FieldCount { field, unusable, .. } = field;
        say!(
            "  {:16} {unusable}: {field} holds no usable value",
            "heights unusable"
        );
    }
    if footprints.duplicates > 0 {
        let duplicates = footprints.duplicates;
        say!(
            "  {:16} {duplicates}: outline equal to an earlier one",
            "duplicates"
        );
    }
}

/// `1234 from "height" (metres), 210 from "building:levels" x 3.2 m, 45 default`.
pub fn heights(footprints: &FootprintReport) -> String {
    let used = footprints.heights.iter().filter(|field| field.buildings > 0);
    let mut parts: Vec<String> = used
        .map(|field| format!("{} from {}", field.buildings, field.field))
        .collect();
    let default: u64 = footprints.default_heights.values().sum();
    if default > 0 || parts.is_empty() {
        parts.push(format!("{default} default"));
    }
    parts.join(", ")
}

fn counted(title: &str, counts: &BTreeMap<String, u64>) {
    for (what, count) in counts {
        say!("  {title:16} {count}: {what}");
    }
}
