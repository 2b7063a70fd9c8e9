//! Whether a table of text ends where its writer ended: GDAL takes a cut one for whole.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use crate::source::SourceError;

/// Separators that GDAL's driver tells apart.
const SEPARATORS: [u8; 4] = *b",;\t|";

/// Refuses a file that ends within a quotation, or in a row with fewer columns than all others.
///
/// # Errors
/// Then, and when it cannot be read.
pub fn require_whole(path: &Path) -> Result<(), SourceError> {
    match fault(path) {
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

fn fault(path: &Path) -> std::io::Result<Option<String>> {
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

/// A file whose quotation marks are counted as it is read.
struct Quotes {
    file: File,
    count: u64,
}

impl Read for Quotes {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let length = self.file.read(buffer)?;
        self.count += buffer[..length].iter().filter(|&&byte| byte == b'"').count() as u64;
        Ok(length)
    }
}
