//! A table's file: CBOR (RFC 8949) packed by zlib (RFC 1950), with the lens it was made for.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::GhostTable;
use crate::camera::lens::{Lens, to_toml};
use crate::source::open_regular;

/// A table cannot be used.
#[derive(Debug, Error)]
pub enum TableError {
    /// The file could not be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// No table, or a damaged one.
    #[error("{path}: is no flare table ({why}); make one with `rilievo lens bake`")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What was found.
        why: String,
    },
    /// Photos that make no table.
    #[error("{path}: {why}")]
    Photos {
        /// The list or a photo.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// Made for something else.
    #[error("{path}: was baked for {what}; bake one for this lens with `rilievo lens bake`")]
    Other {
        /// The file.
        path: PathBuf,
        /// What it is for.
        what: String,
    },
}

#[derive(Serialize, Deserialize)]
struct Body {
    format: String,
    version: u32,
    /// The lens as the project's own table.
    lens: String,
    table: GhostTable,
}

const FORMAT: &str = "rilievo flare table";
const VERSION: u32 = 4;
/// Most bytes of an unpacked file.
const MAX_BYTES: u64 = 128 << 20;

/// Writes a table; returns the file's bytes. The old file stays until the new one is whole.
pub fn write_table(path: &Path, lens: &Lens, table: GhostTable) -> Result<u64, TableError> {
    let file_error = |source| TableError::File {
        path: path.to_owned(),
        source,
    };
    // Nothing is written that cannot be read.
    if !table.is_sound() {
        return Err(TableError::Damaged {
            path: path.to_owned(),
            why: "what was baked has numbers that a table cannot hold".to_owned(),
        });
    }
    let body = Body {
        format: FORMAT.to_owned(),
        version: VERSION,
        lens: to_toml(lens),
        table,
    };
    let mut name = path.as_os_str().to_owned();
    name.push(".partial");
    let partial = PathBuf::from(name);
    let file = File::create(&partial).map_err(file_error)?;
    let mut encoder = ZlibEncoder::new(BufWriter::new(file), Compression::best());
    ciborium::into_writer(&body, &mut encoder)
        .map_err(|error| file_error(std::io::Error::other(error.to_string())))?;
    let mut writer = encoder.finish().map_err(file_error)?;
    writer.flush().map_err(file_error)?;
    writer.get_ref().sync_all().map_err(file_error)?;
    let bytes = writer.get_ref().metadata().map_err(file_error)?.len();
    std::fs::rename(&partial, path).map_err(file_error)?;
    Ok(bytes)
}

/// Reads a table made for this lens, and of rays for this f-number.
pub fn open_table(path: &Path, lens: &Lens, f_number: f64) -> Result<GhostTable, TableError> {
    let file = open_regular(path).map_err(|source| TableError::File {
        path: path.to_owned(),
        source,
    })?;
    let damaged = |why: String| TableError::Damaged {
        path: path.to_owned(),
        why,
    };
    let reader = ZlibDecoder::new(BufReader::new(file)).take(MAX_BYTES);
    let body: Body = ciborium::from_reader(reader).map_err(|error| match error {
        ciborium::de::Error::Io(error) => damaged(error.to_string()),
        other => damaged(other.to_string()),
    })?;
    if body.format != FORMAT || body.version != VERSION {
        return Err(damaged(format!(
            "format '{}', version {}",
            body.format, body.version
        )));
    }
    if !body.table.is_sound() {
        return Err(damaged("its sizes or numbers are wrong".to_owned()));
    }
    let other = |what: String| TableError::Other {
        path: path.to_owned(),
        what,
    };
    if optics_of(&body.lens) != optics_of(&to_toml(lens)) {
        let name = body.lens.lines().find_map(|line| line.strip_prefix("name = "));
        return Err(other(format!("another lens ({})", name.unwrap_or("unnamed"))));
    }
    match body.table.f_number() {
        Some(number) if (number / f_number - 1.0).abs() > 1e-3 => Err(other(format!("f/{number}"))),
        _ => Ok(body.table),
    }
}

/// A lens's table without its name and where it comes from, which change with the path of its file.
fn optics_of(toml: &str) -> Vec<&str> {
    let is_optics = |line: &&str| !line.starts_with("name = ") && !line.starts_with("source = ");
    toml.lines().filter(is_optics).collect()
}
