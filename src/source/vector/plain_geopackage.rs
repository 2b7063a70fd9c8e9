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

/// Tables that a change of a footprint writes to.
const WRITTEN: [&str; 3] = [LAYER, "gpkg_contents", "gpkg_ogr_contents"];
/// Functions of SQLite that make much of little or take long; a definition that calls one would run it at each change.
const COSTLY: [&str; 17] = [
    "zeroblob",
    "randomblob",
    "hex",
    "unhex",
    "printf",
    "format",
    "replace",
    "quote",
    "concat",
    "concat_ws",
    "group_concat",
    "string_agg",
    "like",
    "glob",
    "regexp",
    "match",
    "load_extension",
];
/// Fewest cells of a node of a spatial index but the root (SQLite's R*Tree module fills nodes by a third; those of two dimensions have 51).
const MIN_CELLS: f64 = 17.0;
/// Bytes of such a node: a head, and a cell of 24 bytes each.
const NODE_BYTES: f64 = 4.0 + 24.0 * MIN_CELLS;

/// A statement without the names and texts in it, which may be anything; none where it has a comment, in which they may seem to begin.
fn outside_quotes(sql: &str) -> Option<String> {
    let mut end = None;
    let mut plain = String::new();
    let mut before = ' ';
    for letter in sql.chars() {
        match (end, letter) {
            (Some(quote), _) => {
                if letter == quote {
                    end = None;
                }
                plain.push(' ');
            }
            (None, '"' | '\'' | '`') => {
                end = Some(letter);
                plain.push(' ');
            }
            (None, '[') => {
                end = Some(']');
                plain.push(' ');
            }
            (None, '-' | '*') if (before, letter) == ('-', '-') || before == '/' => return None,
            _ => plain.push(letter),
        }
        before = if end.is_some() { ' ' } else { letter };
    }
    Some(plain)
}

/// Why a definition could make a change of a footprint long, or change others.
fn fault_of_definition(kind: &str, sql: &str) -> Option<String> {
    let lower = sql.to_lowercase();
    let Some(plain) = outside_quotes(&lower) else {
        return Some("its definition has a comment".to_owned());
    };
    let is_letter = |letter: char| letter.is_alphanumeric() || letter == '_';
    // A function can be called by a quoted name.
    let mut calls = lower.match_indices('(').map(|(at, _)| {
        let name = lower[..at].trim_end().trim_end_matches(['"', '\'', '`', ']']);
        name.rsplit(|letter| !is_letter(letter))
            .next()
            .unwrap_or_default()
    });
    if let Some(call) = calls.find(|call| COSTLY.contains(call)) {
        return Some(format!("its definition calls '{call}'"));
    }
    let words: Vec<&str> = plain
        .split(|letter| !is_letter(letter))
        .filter(|word| !word.is_empty())
        .collect();
    if words.windows(2).any(|pair| pair == ["on", "conflict"]) {
        return Some("its definition says what becomes of others 'on conflict'".to_owned());
    }
    (kind == "index" && plain.matches('(').count() > 1)
        .then(|| "an index of it computes what it sorts by".to_owned())
}

/// Why a change of a footprint could be endless, or change others; none where it cannot.
fn fault_of_writing(database: &Connection) -> rusqlite::Result<Option<String>> {
    let mut list = database.prepare(
        "SELECT lower(tbl_name), type, sql FROM sqlite_master WHERE type IN ('table', 'index') AND sql IS NOT NULL",
    )?;
    let definitions: Vec<[String; 3]> = list
        .query_map((), |row| Ok([row.get(0)?, row.get(1)?, row.get(2)?]))?
        .collect::<rusqlite::Result<_>>()?;
    for [table, kind, sql] in definitions {
        if WRITTEN.contains(&table.as_str())
            && let Some(why) = fault_of_definition(&kind, &sql)
        {
            return Ok(Some(format!(
                "'{table}': {why}: a change of a footprint would run it"
            )));
        }
    }
    let mut list = database.prepare(
        "SELECT name FROM sqlite_master WHERE type = 'table' AND name LIKE 'rtree\\_%\\_node' ESCAPE '\\'",
    )?;
    let indices: Vec<String> = list
        .query_map((), |row| row.get(0))?
        .collect::<rusqlite::Result<_>>()?;
    // Counting the nodes would read them all; a file has room for so many.
    let bytes = "SELECT page_count * page_size FROM pragma_page_count, pragma_page_size";
    let max_nodes = database.query_row(bytes, (), |row| row.get::<_, f64>(0))? / NODE_BYTES;
    for name in indices {
        let name = name.replace('"', "\"\"");
        // A node begins with the depth of the tree, where it is the root.
        let query = format!("SELECT hex(substr(data, 1, 2)) FROM \"{name}\" WHERE nodeno = 1");
        let root: Option<Option<String>> = database.query_row(&query, (), |row| row.get(0)).optional()?;
        let depth = root
            .flatten()
            .and_then(|depth| u32::from_str_radix(&depth, 16).ok())
            .unwrap_or(0);
        if f64::from(depth) > 2.0 + max_nodes.max(1.0).log(MIN_CELLS) {
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
    match fault(path) {
        Ok(None) => Ok(()),
        Ok(Some(what)) => Err(SourceError::Unfit {
            path: path.to_owned(),
            what,
            advice: "a city's dataset holds footprints and runs nothing; take that out of it, with a GIS or sqlite3".to_owned(),
        }),
        Err(error) => Err(SourceError::Open {
            path: path.to_owned(),
            why: error.to_string(),
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
        // Of a spatial index and its own tables SQLite keeps the order; a change writes to them.
        let is_index = name.to_ascii_lowercase().starts_with("rtree_");
        if is_index && kind != "virtual" && kind != "shadow" {
            return Ok(Some(format!("its '{name}' is a {kind}, not a spatial index")));
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
    if let Some(why) = fault_of_writing(&database)? {
        return Ok(Some(why));
    }
    let mut list =
        database.prepare("SELECT name, tbl_name, sql FROM sqlite_master WHERE type = 'trigger'")?;
    let triggers: Vec<[String; 3]> = list
        .query_map((), |row| Ok([row.get(0)?, row.get(1)?, row.get(2)?]))?
        .collect::<rusqlite::Result<_>>()?;
    let other = triggers
        .into_iter()
        .find(|[_, table, sql]| is_reachable(table, &WRITTEN) && !is_own_trigger(sql, LAYER));
    Ok(other.map(|[name, ..]| format!("its trigger '{name}' does more than keep index and count; drop it")))
}
