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
    collect(path, MAX_DEPTH, &mut files);
    files
}

fn collect(path: &Path, depth: usize, files: &mut BTreeSet<PathBuf>) {
    if depth == 0 {
        return;
    }
    if path.is_dir() {
        for entry in std::fs::read_dir(path).into_iter().flatten().flatten() {
            collect(&entry.path(), depth - 1, files);
        }
        return;
    }
    if !files.insert(path.to_owned()) {
        return;
    }
    files.extend(beside(path));
    let named = gdal_files(path);
    for file in named {
        let is_mosaic = file
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("vrt"));
        if is_mosaic && file != path {
            collect(&file, depth - 1, files);
        } else {
            files.insert(file);
        }
    }
}

/// The file's companions of the same name (.dbf, .prj, world files, `.aux.xml`).
fn beside(path: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new(".")));
    let stem = path.file_stem().map(ToOwned::to_owned);
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    entries
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .filter(move |file| {
            let is_companion = name
                .as_ref()
                .zip(file.file_name())
                .is_some_and(|(name, file)| file.to_string_lossy().starts_with(&format!("{name}.")));
            let is_lock = file.extension().is_some_and(|ending| ending == "lock");
            !is_lock && file.is_file() && (file.file_stem() == stem.as_deref() || is_companion)
        })
}

/// What GDAL says that it opened; nothing for what it cannot open.
fn gdal_files(path: &Path) -> Vec<PathBuf> {
    let Ok(name) = CString::new(path.to_string_lossy().as_bytes()) else {
        return Vec::new();
    };
    gdal::DriverManager::register_all();
    let mut files = Vec::new();
    // SAFETY: the name outlives the calls; the list is GDAL's until it is destroyed, and its texts are copied before.
    unsafe {
        gdal_sys::CPLPushErrorHandler(Some(gdal_sys::CPLQuietErrorHandler));
        let flags = (GdalOpenFlags::GDAL_OF_RASTER | GdalOpenFlags::GDAL_OF_VECTOR).bits();
        let none = std::ptr::null();
        let dataset = gdal_sys::GDALOpenEx(name.as_ptr(), flags, none, none, none);
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
