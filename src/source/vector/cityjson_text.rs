//! The text of a CityJSON file: where it is, plain or in an archive, and whether it can be held.

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::source::sound_file::in_zip;

/// The path GDAL's file system reads a CityJSON text at, when the file is one (plain or zipped).
pub fn virtual_path(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_string_lossy().to_lowercase();
    if name.ends_with(".city.json.zip") {
        let inside = path.file_stem()?.to_owned();
        return Some(in_zip(path).join(inside));
    }
    if !name.ends_with(".json") {
        return None;
    }
    // One too large to be held is told from its beginning, where writers put it.
    let mut text = Vec::new();
    let mut file = std::fs::File::open(path).ok()?;
    let bytes = file.metadata().ok()?.len();
    let told = if bytes > MAX_TEXT { HEAD } else { bytes };
    Read::by_ref(&mut file).take(told).read_to_end(&mut text).ok()?;
    let mark = b"\"CityJSON\"";
    text.windows(mark.len())
        .any(|window| window == mark)
        .then(|| path.to_owned())
}

/// Most bytes of a CityJSON text, which is read as a whole, and those in which a longer one is told.
const MAX_TEXT: u64 = 1 << 31;
const HEAD: u64 = 1 << 16;

/// Reads the text.
///
/// # Errors
/// Why it cannot be read, or not be held.
pub fn read_text(path: &Path) -> Result<Vec<u8>, String> {
    let text = whole_text(path)?;
    match memory_bytes(&text) > MAX_MEMORY {
        true => Err("it holds more than can be read at once; divide it, for example with cjio".to_owned()),
        false => Ok(text),
    }
}

fn whole_text(path: &Path) -> Result<Vec<u8>, String> {
    if !path.starts_with("/vsizip") {
        let bytes = std::fs::metadata(path).map_err(|error| error.to_string())?.len();
        return match bytes > MAX_TEXT {
            true => Err("it is larger than 2 GiB; divide it, for example with cjio".to_owned()),
            false => std::fs::read(path).map_err(|error| error.to_string()),
        };
    }
    use gdal::vsi;
    let name = path.to_string_lossy();
    let c_name = std::ffi::CString::new(name.as_bytes()).map_err(|error| error.to_string())?;
    // GDAL unpacks the member to its memory file system, whose bytes are then ours.
    let memory = format!("/vsimem/rilievo-{}.json", std::process::id());
    let c_memory = std::ffi::CString::new(memory.as_bytes()).map_err(|error| error.to_string())?;
    // SAFETY: both names are valid C strings for the call.
    let copied = unsafe { gdal_sys::CPLCopyFile(c_memory.as_ptr(), c_name.as_ptr()) };
    if copied != 0 {
        return Err(format!("no member {name} in the archive"));
    }
    vsi::get_vsi_mem_file_bytes_owned(&memory).map_err(|error| error.to_string())
}

/// Bytes of memory that a list or an object of a text takes when read, and one of its members, and how many all may take.
const LIST_BYTES: usize = 128;
const MEMBER_BYTES: usize = 32;
const MAX_MEMORY: usize = 900_000_000;

/// How much memory a JSON text takes, by its brackets and commas.
fn memory_bytes(text: &[u8]) -> usize {
    let bytes_of = |&byte: &u8| match byte {
        b'[' | b'{' => LIST_BYTES,
        b',' => MEMBER_BYTES,
        _ => 0,
    };
    text.iter().map(bytes_of).sum()
}
