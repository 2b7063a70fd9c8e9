//! Whether a GeoPackage holds its features itself: a view can run without end, and a virtual table of a module that GDAL brings reads
//! other files.

use std::path::Path;

use rusqlite::{Connection, OpenFlags};

use super::footprint_dataset::LAYER;
use crate::source::SourceError;

/// Refuses a footprint dataset whose layer is no table of its own, or that has virtual tables beyond SQLite's own modules.
///
/// # Errors
/// Then, and when it is no database.
pub fn require_plain(path: &Path) -> Result<(), SourceError> {
    let fault = fault(path).unwrap_or_else(|error| Some(error.to_string()));
    match fault {
        None => Ok(()),
        Some(why) => Err(SourceError::Open {
            path: path.to_owned(),
            why,
            expected: "GeoPackage",
        }),
    }
}

fn fault(path: &Path) -> rusqlite::Result<Option<String>> {
    // A connection without any module but those that SQLite is built with; nothing is run, only prepared.
    let database = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_ONLY)?;
    database.pragma_update(None, "trusted_schema", false)?;
    let mut list = database.prepare("SELECT name, type FROM pragma_table_list WHERE schema = 'main'")?;
    let tables: Vec<(String, String)> = list
        .query_map((), |row| Ok((row.get(0)?, row.get(1)?)))?
        .collect::<rusqlite::Result<_>>()?;
    for (name, kind) in tables {
        if name.eq_ignore_ascii_case(LAYER) && kind != "table" {
            return Ok(Some(format!("its '{name}' are a {kind}, not a table")));
        }
        let quoted = name.replace('"', "\"\"");
        if kind == "virtual" && database.prepare(&format!("SELECT * FROM \"{quoted}\"")).is_err() {
            return Ok(Some(format!(
                "its virtual table '{name}' is of a module that could read other files"
            )));
        }
    }
    Ok(None)
}
