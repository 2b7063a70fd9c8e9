//! What is looked at before GDAL opens a file: whether it is one, and whether to read it is bounded work.
//!
//! A pipe keeps its reader waiting and a device never ends; some megabytes of archive may unpack to gigabytes; where each mosaic
//! names the next one twice, twenty of them are read a million times.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};

use super::SourceError;
use super::archive::archive_of;
use super::files::{describes_others, files_described, underlying};

/// Most bytes that an archive may unpack to where that is more than `MAX_UNPACKING` times its own: texts and tables come to a
/// tenth of it.
const MAX_UNPACKED: u64 = 1 << 25;
const MAX_UNPACKING: u64 = 100;
/// Most files of an archive: GDAL looks each of them up among all.
const MAX_MEMBERS: u64 = 10_000;

/// Most reads of files that one read of a mosaic of mosaics may lead to, and the levels from which that is asked.
const MAX_READS: u64 = 100_000;
const NESTED: u32 = 2;
/// Levels followed.
const MAX_LEVELS: u32 = 6;

/// Refuses what is no file or folder, an archive that unpacks to far more than it holds, and mosaics nested beyond reading. What GDAL
/// names otherwise (a database, an address) is left to it.
///
/// # Errors
/// What is wrong with the file, and what to do.
pub fn require_sound(path: &Path) -> Result<(), SourceError> {
    let file = underlying(path);
    let unfit = |what: String, advice: &str| SourceError::Unfit {
        path: path.to_owned(),
        what,
        advice: advice.to_owned(),
    };
    let Ok(data) = std::fs::metadata(&file) else {
        return Ok(());
    };
    if data.is_dir() {
        return Ok(());
    }
    if !data.is_file() {
        return Err(unfit(
            "is no plain file".to_owned(),
            "copy what it gives into a file, and give that",
        ));
    }
    let archive = archive_of(&file);
    if let Some(archive) = archive
        && archive.members > MAX_MEMBERS
    {
        return Err(unfit(
            format!("is an archive of {} files", archive.members),
            "unpack it yourself, and give the file or folder inside",
        ));
    }
    if let Some(unpacked) = archive.map(|archive| archive.unpacked_bytes)
        && unpacked > MAX_UNPACKED
        && unpacked / MAX_UNPACKING > data.len()
    {
        let [unpacked, packed] = [unpacked, data.len()].map(|bytes| bytes as f64 / 1e6);
        return Err(unfit(
            format!("unpacks from {packed:.1} MB to {unpacked:.0} MB, as no survey does"),
            "unpack it yourself if you trust it, and give the file inside",
        ));
    }
    let (reads, levels) = reads_of(&file, MAX_LEVELS);
    if levels > MAX_LEVELS || (levels > NESTED && reads > MAX_READS) {
        return Err(unfit(
            "is a mosaic of mosaics nested too deep to be read".to_owned(),
            "make one of the rasters themselves, with gdalbuildvrt",
        ));
    }
    Ok(())
}

/// Opens a file to read, no pipe, which keeps its reader waiting, and no device.
///
/// # Errors
/// When it is one, or cannot be opened.
pub fn open_regular(path: &Path) -> IoResult<File> {
    match std::fs::metadata(path)?.is_file() {
        true => File::open(path),
        false => Err(Error::new(ErrorKind::InvalidInput, "is no plain file")),
    }
}

/// GDAL's name for the inside of an archive: `/vsizip/` and the absolute path.
pub fn in_zip(path: &Path) -> PathBuf {
    let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    PathBuf::from(format!("/vsizip/{}", full.display()))
}

/// How many reads of files one read of a mosaic leads to, and over how many levels; one on none for a file that is no mosaic.
fn reads_of(file: &Path, levels: u32) -> (u64, u32) {
    let is_text = std::fs::metadata(file).as_ref().is_ok_and(Metadata::is_file) && describes_others(file);
    if !is_text {
        return (1, 0);
    }
    if levels == 0 {
        return (u64::MAX, 1);
    }
    let text = std::fs::read_to_string(file).unwrap_or_default();
    let named = text.matches("<SourceFilename").count() + text.matches("<SourceDataset").count();
    let parts = files_described(file);
    let parts = parts.iter().filter(|part| part.as_path() != file);
    // The parts by the deepest, all as often as they are named: a bound, not a count.
    let (reads, below) = parts
        .map(|part| reads_of(part, levels - 1))
        .fold((1, 0), |(reads, below), (of, levels)| {
            (of.max(reads), levels.max(below))
        });
    (reads.saturating_mul(named.max(1) as u64), below + 1)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_too_often_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mosaic = |level: usize| folder.path().join(format!("{level}.vrt"));
        for level in 0..6 {
            let part = match level {
                0 => "raster.tif".to_owned(),
                _ => format!("{}.vrt", level - 1),
            };
            let source = format!(
                "<SimpleSource><SourceFilename relativeToVRT=\"1\">{part}</SourceFilename><SourceBand>1</SourceBand></SimpleSource>"
            );
            let text = format!(
                "<VRTDataset rasterXSize=\"9\" rasterYSize=\"9\"><VRTRasterBand dataType=\"Float32\" band=\"1\">{}</VRTRasterBand></VRTDataset>",
                source.repeat(100)
            );
            std::fs::write(mosaic(level), text).unwrap();
        }
        assert!(require_sound(&mosaic(0)).is_ok());
        assert!(require_sound(&mosaic(1)).is_ok());
        assert!(require_sound(&mosaic(5)).is_err());
    }
}
