//! The files that a source is made of: what GDAL opens for it, and what those name in turn.

use std::collections::BTreeSet;
use std::ffi::{CStr, CString};
use std::path::{Path, PathBuf};

use gdal::GdalOpenFlags;

/// Mosaics of mosaics are followed so deep.
const MAX_DEPTH: usize = 8;

/// All files of a source, in order: itself, its companions of the same name, and every file that GDAL opens for it or for a part of it. A
/// folder's are all in it.
pub fn files_of(path: &Path) -> BTreeSet<PathBuf> {
    let mut files = BTreeSet::new();
    let path = underlying(path);
    collect(&path, MAX_DEPTH, &mut files);
    // A raster's header may lie beside it under any name; to look for one in a vector file is to read it.
    if path.is_file() {
        files.extend(gdal_files(&path, GdalOpenFlags::GDAL_OF_RASTER));
    }
    files
}

/// The file on disk behind one of GDAL's names for a part of a file: `/vsizip/a.zip/b.tif` lies in `a.zip`, `vrt://a.tif?bands=1` is read
/// from `a.tif`. Any other path is its own.
pub(super) fn underlying(path: &Path) -> PathBuf {
    let text = path.to_string_lossy();
    let mut name = match text.strip_prefix("vrt://") {
        Some(rest) => rest.split('?').next().unwrap_or(rest),
        None => &text,
    };
    // `/vsizip//vsigzip/...`: each prefix ends with a slash, absolute paths follow after another.
    while let Some((_, rest)) = name.strip_prefix("/vsi").and_then(|rest| rest.split_once('/')) {
        name = rest;
    }
    let inner = Path::new(name);
    let file = inner.ancestors().find(|ancestor| ancestor.is_file());
    file.unwrap_or(path).to_owned()
}

/// Endings of what lies beside a raster or dataset and is part of it.
const COMPANIONS: [&str; 20] = [
    "dbf", "shx", "prj", "cpg", "qpj", "tfw", "tifw", "wld", "jgw", "jpw", "pgw", "j2w", "xml", "ovr", "msk",
    "gfs", "xsd", "csvt", "hdr", "ers",
];
/// Bytes of a file's head that tell whether it is a text.
const HEAD: u64 = 512;
/// Bytes of a text that tell whether it is a description of others: more than any comment before it.
const TEXT_HEAD: u64 = 1 << 20;

fn collect(path: &Path, depth: usize, files: &mut BTreeSet<PathBuf>) {
    if depth == 0 {
        return;
    }
    if path.is_dir() {
        for entry in std::fs::read_dir(path).into_iter().flatten().flatten() {
            let ending = entry
                .path()
                .extension()
                .map(|ending| ending.to_string_lossy().to_lowercase());
            // What an import leaves, and what a program that has a dataset open keeps beside it.
            let is_passing = ["partial", "previous", "lock"]
                .iter()
                .any(|passing| ending.as_deref() == Some(passing));
            if !is_passing {
                collect(&entry.path(), depth - 1, files);
            }
        }
        return;
    }
    if !files.insert(path.to_owned()) {
        return;
    }
    files.extend(companions(path));
    // Only a description names others; to open all would be to read all.
    if describes_others(path) {
        for file in files_described(path) {
            if file != path {
                collect(&file, depth - 1, files);
            }
        }
    }
}

/// The file's companions: of the same name with another ending, or with one more.
fn companions(path: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let stem = path.with_extension("");
    let whole = path.as_os_str().to_owned();
    let candidates = COMPANIONS.into_iter().flat_map(move |ending| {
        let with = |base: &std::ffi::OsStr, middle: &str| {
            let mut name = base.to_owned();
            name.push(format!("{middle}.{ending}"));
            PathBuf::from(name)
        };
        let upper = stem.with_extension(ending.to_uppercase());
        [
            with(stem.as_os_str(), ""),
            upper,
            with(&whole, ""),
            with(&whole, ".aux"),
        ]
    });
    candidates.filter(|file| file.is_file())
}

/// Whether a file is text that names other files, as GDAL's virtual formats are.
pub(super) fn describes_others(path: &Path) -> bool {
    use std::io::Read;
    let mut head = Vec::new();
    let read = std::fs::File::open(path).and_then(|mut file| {
        Read::by_ref(&mut file).take(HEAD).read_to_end(&mut head)?;
        // A text has no byte 0.
        match head.contains(&0) {
            true => Ok(0),
            false => file.take(TEXT_HEAD).read_to_end(&mut head),
        }
    });
    let text = String::from_utf8_lossy(&head);
    read.is_ok()
        && ["VRTDataset", "VRTDataSource", "VRTTI"]
            .iter()
            .any(|name| text.contains(name))
}

/// The files that a description names, as GDAL says; itself with them.
pub(super) fn files_described(path: &Path) -> Vec<PathBuf> {
    gdal_files(
        path,
        GdalOpenFlags::GDAL_OF_RASTER | GdalOpenFlags::GDAL_OF_VECTOR,
    )
}

/// What GDAL says that it opened; nothing for what it cannot open.
fn gdal_files(path: &Path, kinds: GdalOpenFlags) -> Vec<PathBuf> {
    let Ok(name) = CString::new(path.to_string_lossy().as_bytes()) else {
        return Vec::new();
    };
    gdal::DriverManager::register_all();
    let mut files = Vec::new();
    // SAFETY: the name outlives the calls; the list is GDAL's until it is destroyed, and its texts are copied before.
    unsafe {
        gdal_sys::CPLPushErrorHandler(Some(gdal_sys::CPLQuietErrorHandler));
        let none = std::ptr::null();
        let dataset = gdal_sys::GDALOpenEx(name.as_ptr(), kinds.bits(), none, none, none);
        if !dataset.is_null() {
            let list = gdal_sys::GDALGetFileList(dataset);
            let mut at = list;
            while !at.is_null() && !(*at).is_null() {
                files.push(PathBuf::from(CStr::from_ptr(*at).to_string_lossy().into_owned()));
                at = at.add(1);
            }
            gdal_sys::CSLDestroy(list);
            gdal_sys::GDALClose(dataset);
        }
        gdal_sys::CPLPopErrorHandler();
    }
    files
}
