//! How much an archive unpacks to, as it says itself; GDAL unpacks no more of a member than that.

use std::fs::File;
use std::io::{Read, Result, Seek, SeekFrom};
use std::path::Path;

/// End of a ZIP archive's directory, and an entry in it (PKWARE APPNOTE 6.3, 4.3.16 and 4.3.12): marks, lengths without what follows,
/// and the places of the numbers that are read.
const END_MARK: [u8; 4] = *b"PK\x05\x06";
const END_BYTES: usize = 22;
const END_SIZE_AT: usize = 12;
const ENTRY_MARK: [u8; 4] = *b"PK\x01\x02";
const ENTRY_BYTES: usize = 46;
const ENTRY_UNPACKED_AT: usize = 24;
const ENTRY_NAMES_AT: usize = 28;
/// Longest comment after the end, and the largest directory that is read.
const MAX_COMMENT: u64 = 1 << 16;
const MAX_DIRECTORY: u64 = 1 << 26;
/// How a gzip file begins (RFC 1952, 2.3.1).
const GZIP_MARK: [u8; 2] = [0x1f, 0x8b];

/// What an archive holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Archive {
    /// Files in it.
    pub members: u64,
    /// Their bytes, unpacked, without dBASE tables; of a gzip file modulo 4 GiB.
    pub unpacked_bytes: u64,
}

/// What a ZIP archive or a gzip file holds; none of another file.
pub fn archive_of(path: &Path) -> Option<Archive> {
    let mut file = File::open(path).ok()?;
    let mut mark = [0; 2];
    file.read_exact(&mut mark).ok()?;
    match mark == GZIP_MARK {
        true => gzip(&mut file).ok(),
        false => zip(&mut file).ok().flatten(),
    }
}

fn gzip(file: &mut File) -> Result<Archive> {
    file.seek(SeekFrom::End(-4))?;
    let mut size = [0; 4];
    file.read_exact(&mut size)?;
    Ok(Archive {
        members: 1,
        unpacked_bytes: u64::from(u32::from_le_bytes(size)),
    })
}

fn zip(file: &mut File) -> Result<Option<Archive>> {
    let length = file.metadata()?.len();
    let tail_from = length.saturating_sub(MAX_COMMENT + END_BYTES as u64);
    file.seek(SeekFrom::Start(tail_from))?;
    let mut tail = Vec::new();
    file.read_to_end(&mut tail)?;
    let ends = tail
        .windows(END_BYTES)
        .rposition(|end| end.starts_with(&END_MARK));
    let Some(end) = ends else {
        return Ok(None);
    };
    // The directory lies before its end; what is said of its place counts from the archive's beginning, before which others may lie.
    let size = u64::from(number(&tail[end..], END_SIZE_AT)).min(MAX_DIRECTORY);
    let from = (tail_from + end as u64).saturating_sub(size);
    file.seek(SeekFrom::Start(from))?;
    let mut directory = Vec::new();
    file.take(size).read_to_end(&mut directory)?;
    let mut at = 0;
    let mut archive = Archive {
        members: 0,
        unpacked_bytes: 0,
    };
    while let Some(entry) = directory.get(at..at + ENTRY_BYTES)
        && entry.starts_with(&ENTRY_MARK)
    {
        archive.members += 1;
        let names = [0, 1, 2].map(|k| {
            let place = ENTRY_NAMES_AT + 2 * k;
            usize::from(u16::from_le_bytes([entry[place], entry[place + 1]]))
        });
        let [name, more, comment] = names;
        let bytes = directory.get(at + ENTRY_BYTES..).unwrap_or_default();
        let name_bytes = &bytes[..name.min(bytes.len())];
        // A dBASE table pads its texts with blanks, which pack to nothing; it is read row by row.
        if !name_bytes.to_ascii_lowercase().ends_with(b".dbf") {
            archive.unpacked_bytes += u64::from(number(entry, ENTRY_UNPACKED_AT));
        }
        at += ENTRY_BYTES + name + more + comment;
    }
    Ok(Some(archive))
}

fn number(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// An archive of stored members that say what they unpack to.
    fn archive(sizes: &[u32], before: &str) -> Vec<u8> {
        let mut directory = Vec::new();
        for &size in sizes {
            let mut entry = vec![0; ENTRY_BYTES];
            entry[..4].copy_from_slice(&ENTRY_MARK);
            entry[ENTRY_UNPACKED_AT..ENTRY_UNPACKED_AT + 4].copy_from_slice(&size.to_le_bytes());
            entry[ENTRY_NAMES_AT] = 5;
            entry.extend(b"a.txt");
            directory.extend(entry);
        }
        let mut end = vec![0; END_BYTES];
        end[..4].copy_from_slice(&END_MARK);
        end[END_SIZE_AT..END_SIZE_AT + 4].copy_from_slice(&(directory.len() as u32).to_le_bytes());
        [before.as_bytes(), &directory, &end, b"a comment"].concat()
    }

    #[test]
    fn members_are_added_up() {
        let folder = tempfile::tempdir().unwrap();
        let bytes = |content: &[u8]| {
            let path = folder.path().join("a.zip");
            std::fs::write(&path, content).unwrap();
            archive_of(&path).map(|archive| archive.unpacked_bytes)
        };
        assert_eq!(bytes(&archive(&[3, 5, 700_000_000], "")), Some(700_000_008));
        assert_eq!(bytes(&archive(&[7], "not an archive yet")), Some(7));
        assert_eq!(bytes(b"PK"), None);
        assert_eq!(bytes(&[0x1f, 0x8b, 8, 0, 0, 1, 0, 0]), Some(256));
        let mut cut = archive(&[3, 5], "");
        cut.drain(..ENTRY_BYTES);
        assert!(bytes(&cut).is_some_and(|bytes| bytes <= 8));
    }
}
