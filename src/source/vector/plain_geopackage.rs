//! Whether a GeoPackage holds its features itself: a view can run without end, and a virtual table of a module that GDAL brings reads
//! other files.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use rusqlite::{Connection, OpenFlags, OptionalExtension};

use super::footprint_dataset::LAYER;
use super::own_triggers::{is_own_trigger, is_reachable};
use crate::source::SourceError;

/// Last bytes of a journal that names another file: the super-journal of several databases ("The Rollback Journal" of SQLite's file
/// format). SQLite deletes that file when it rolls back; no dataset of a city has one.
const SUPER_JOURNAL: [u8; 8] = [0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7];

/// Takes back what a killed program had written of a transaction: what its journal tells.
///
/// # Errors
/// When the journal names another file, or the dataset cannot be written.
pub fn roll_back(path: &Path) -> Result<(), SourceError> {
    let mut journal = path.as_os_str().to_owned();
    journal.push("-journal");
    let journal = Path::new(&journal);
    let error = |path: &Path, why: String| SourceError::Open {
        path: path.to_owned(),
        why,
        expected: "GeoPackage",
    };
    let Ok(data) = std::fs::symlink_metadata(journal) else {
        return Ok(());
    };
    if !data.is_file() || !std::fs::symlink_metadata(path).is_ok_and(|data| data.is_file()) {
        return Err(error(journal, "it is no journal of this dataset".to_owned()));
    }
    if names_other_file(journal).map_err(|why| error(journal, why.to_string()))? {
        return Err(error(
            journal,
            "it is a journal that names another file; take it away".to_owned(),
        ));
    }
    let rolled_back =
        Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_WRITE).and_then(|database| {
            database.pragma_update(None, "trusted_schema", false)?;
            database.query_row("SELECT count(*) FROM sqlite_master", (), |_| Ok(()))
        });
    rolled_back.map_err(|why| error(path, why.to_string()))
}

fn names_other_file(journal: &Path) -> std::io::Result<bool> {
    let mut file = File::open(journal)?;
    if file.metadata()?.len() < SUPER_JOURNAL.len() as u64 {
        return Ok(false);
    }
    let mut end = [0; SUPER_JOURNAL.len()];
    file.seek(SeekFrom::End(-(SUPER_JOURNAL.len() as i64)))?;
    file.read_exact(&mut end)?;
    Ok(end == SUPER_JOURNAL)
}

/// Words in the definition of the layer and of its indices by which a change of a footprint runs something, or changes others.
const RUNNING: [&str; 5] = ["check", "conflict", "cascade", "zeroblob", "where"];
/// Fewest cells of a node of a spatial index but the root (SQLite's R*Tree module fills nodes by a third; those of two dimensions have 51).
const MIN_CELLS: f64 = 17.0;

/// A statement without the names and texts in it, which may be anything.
fn outside_quotes(sql: &str) -> String {
    let mut end = None;
    sql.chars()
        .map(|letter| match (end, letter) {
            (Some(quote), _) => {
                if letter == quote {
                    end = None;
                }
                ' '
            }
            (None, '"' | '\'' | '`') => {
                end = Some(letter);
                ' '
            }
            (None, '[') => {
                end = Some(']');
                ' '
            }
            _ => letter,
        })
        .collect()
}

/// Why the layer's definition or its spatial index could make a change of a footprint endless; none where they cannot.
fn fault_of_layer(database: &Connection) -> rusqlite::Result<Option<String>> {
    let mut list = database.prepare(
        "SELECT sql FROM sqlite_master WHERE tbl_name = ?1 COLLATE NOCASE AND type IN ('table', 'index')",
    )?;
    let definitions: Vec<Option<String>> = list
        .query_map([LAYER], |row| row.get(0))?
        .collect::<rusqlite::Result<_>>()?;
    for sql in definitions.into_iter().flatten() {
        let plain = outside_quotes(&sql.to_lowercase());
        let mut words = plain.split(|letter: char| !(letter.is_alphanumeric() || letter == '_'));
        if let Some(word) = words.find(|word| RUNNING.contains(word)) {
            return Ok(Some(format!(
                "its definition has '{word}': a change of a footprint would run it"
            )));
        }
        let is_index = plain.trim_start().starts_with("create") && !plain.contains("table");
        if is_index && plain.matches('(').count() > 1 {
            return Ok(Some("an index of it computes what it sorts by".to_owned()));
        }
    }
    let mut list = database.prepare(
        "SELECT name FROM sqlite_master WHERE type = 'table' AND name LIKE 'rtree\\_%\\_node' ESCAPE '\\'",
    )?;
    let indices: Vec<String> = list
        .query_map((), |row| row.get(0))?
        .collect::<rusqlite::Result<_>>()?;
    for name in indices {
        let name = name.replace('"', "\"\"");
        // A node begins with the depth of the tree, where it is the root.
        let query = format!(
            "SELECT (SELECT count(*) FROM \"{name}\"), (SELECT hex(substr(data, 1, 2)) FROM \"{name}\" WHERE nodeno = 1)"
        );
        let (nodes, depth): (f64, Option<String>) =
            database.query_row(&query, (), |row| Ok((row.get(0)?, row.get(1)?)))?;
        let depth = depth
            .and_then(|depth| u32::from_str_radix(&depth, 16).ok())
            .unwrap_or(0);
        if f64::from(depth) > 2.0 + nodes.max(1.0).log(MIN_CELLS) {
            return Ok(Some(
                "its spatial index is none: it is deeper than its nodes allow".to_owned(),
            ));
        }
    }
    Ok(None)
}

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
        // GDAL reads these before the layer.
        if kind == "view" && name.to_ascii_lowercase().starts_with("gpkg_") {
            return Ok(Some(format!("its '{name}' is a view, not a table")));
        }
        let quoted = name.replace('"', "\"\"");
        if kind == "virtual" && database.prepare(&format!("SELECT * FROM \"{quoted}\"")).is_err() {
            return Ok(Some(format!(
                "its virtual table '{name}' is of a module that could read other files"
            )));
        }
    }
    let generated = "SELECT name FROM pragma_table_xinfo(?1) WHERE hidden > 1";
    let column = database.query_row(generated, [LAYER], |row| row.get::<_, String>(0));
    if let Some(column) = column.optional()? {
        return Ok(Some(format!("its column '{column}' is generated, not stored")));
    }
    if let Some(why) = fault_of_layer(&database)? {
        return Ok(Some(why));
    }
    let mut list =
        database.prepare("SELECT name, tbl_name, sql FROM sqlite_master WHERE type = 'trigger'")?;
    let triggers: Vec<[String; 3]> = list
        .query_map((), |row| Ok([row.get(0)?, row.get(1)?, row.get(2)?]))?
        .collect::<rusqlite::Result<_>>()?;
    let other = triggers
        .into_iter()
        .find(|[_, table, sql]| is_reachable(table, LAYER) && !is_own_trigger(sql, LAYER));
    Ok(other.map(|[name, ..]| format!("its trigger '{name}' does more than keep index and count; drop it")))
}
