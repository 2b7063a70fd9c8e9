//! Whether a file ends where its writer ended, in formats of which GDAL takes a cut one for whole.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Result, Seek, SeekFrom};
use std::path::Path;

use crate::source::SourceError;

/// Separators that GDAL's driver tells apart.
const SEPARATORS: [u8; 4] = *b",;\t|";

/// What ends a design file (Intergraph Standard File Formats, element headers), before padding with zeros.
const END_OF_DESIGN: [u8; 2] = [0xff, 0xff];
/// Most bytes of such padding that are looked through.
const MAX_PADDING: u64 = 1 << 16;

/// Refuses a table of text that ends within a quotation or in a row with fewer columns than all others, a design file without its end,
/// and lines of GMT of which the last is cut. `driver`: by which GDAL reads it.
///
/// # Errors
/// Then, and when it cannot be read.
pub fn require_end(path: &Path, driver: &str) -> std::result::Result<(), SourceError> {
    if !path.is_file() {
        return Ok(());
    }
    let fault = match driver {
        "CSV" => fault_of_table(path),
        "DGN" => tail(path).map(|tail| {
            let padding = tail.iter().rev().take_while(|&&byte| byte == 0).count();
            let is_ended = tail[..tail.len() - padding].ends_with(&END_OF_DESIGN);
            (!is_ended).then(|| "its end is missing".to_owned())
        }),
        "OGR_GMT" => tail(path).map(|tail| {
            let is_ended = tail.last().is_none_or(|&byte| byte == b'\n');
            (!is_ended).then(|| "it ends within a line".to_owned())
        }),
        _ => return Ok(()),
    };
    match fault {
        Ok(None) => Ok(()),
        Ok(Some(why)) => Err(SourceError::Read {
            path: path.to_owned(),
            why,
        }),
        Err(error) => Err(SourceError::Read {
            path: path.to_owned(),
            why: error.to_string(),
        }),
    }
}

/// A file's last bytes.
fn tail(path: &Path) -> Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(MAX_PADDING)))?;
    let mut tail = Vec::new();
    file.read_to_end(&mut tail)?;
    Ok(tail)
}

fn fault_of_table(path: &Path) -> Result<Option<String>> {
    let mut header = Vec::new();
    BufReader::new(File::open(path)?)
        .take(1 << 20)
        .read_until(b'\n', &mut header)?;
    let count = |separator: &u8| header.iter().filter(|&byte| byte == separator).count();
    let separator = SEPARATORS.into_iter().max_by_key(count).unwrap_or(b',');
    let mut quotes = Quotes {
        file: File::open(path)?,
        count: 0,
    };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .from_reader(&mut quotes);
    let mut row = csv::ByteRecord::new();
    // Fewest columns of the rows before the last.
    let (mut fewest, mut last, mut rows) = (usize::MAX, usize::MAX, 0_u64);
    while reader.read_byte_record(&mut row)? {
        fewest = fewest.min(last);
        last = row.len();
        rows += 1;
    }
    drop(reader);
    if !quotes.count.is_multiple_of(2) {
        return Ok(Some("it ends within a quotation".to_owned()));
    }
    let is_short = fewest != usize::MAX && last < fewest;
    Ok(is_short
        .then(|| format!("its last row, number {rows}, has {last} columns, all others {fewest} or more")))
}

/// Rows of the table beside a MapInfo interchange file, one for each of its features; 0 of any other file.
pub fn rows_beside(path: &Path) -> u64 {
    let is_interchange = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("mif"));
    let table = ["mid", "MID"].map(|ending| path.with_extension(ending));
    let table = table.iter().find(|table| table.is_file());
    let lines = |file| BufReader::new(file).split(b'\n').map_while(Result::ok);
    let file = table
        .filter(|_| is_interchange)
        .and_then(|table| File::open(table).ok());
    file.map_or(0, |file| {
        lines(file).filter(|line| !line.trim_ascii().is_empty()).count() as u64
    })
}

/// A file whose quotation marks are counted as it is read.
struct Quotes {
    file: File,
    count: u64,
}

impl Read for Quotes {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let length = self.file.read(buffer)?;
        self.count += buffer[..length].iter().filter(|&&byte| byte == b'"').count() as u64;
        Ok(length)
    }
}
