//! Which files are a city's own, and how they are read: nothing that a city folder holds leads out of it, and nothing is read without end.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use super::CityError;
use super::layer::Layer;

/// Folder beside a city's rules with the pictures of facades that they name.
pub const PICTURES: &str = "facades";

/// Folder of an update in the making.
pub const PARTIAL: &str = "update.partial";
/// Folder of an update that holds.
pub const COMMITTED: &str = "update.commit";
/// Of what a city may hold at its top the folders, beside those of its layers and pictures.
const FOLDERS: [&str; 2] = [PARTIAL, COMMITTED];

/// Most bytes of `city.toml` and of an update's plan.
pub const MAX_TEXT: u64 = 16 << 20;

/// Opens a city's own file: no link, nothing but a plain file.
///
/// # Errors
/// When it is something else, or cannot be opened.
pub fn open_plain(path: &Path) -> Result<File, CityError> {
    let refused = |why: &str| CityError::File {
        path: path.to_owned(),
        why: why.to_owned(),
    };
    let data = fs::symlink_metadata(path).map_err(CityError::file(path))?;
    if data.is_symlink() {
        return Err(refused("is a link; a city's files lie in its folder"));
    }
    if !data.is_file() {
        return Err(refused("is no plain file"));
    }
    #[cfg(unix)]
    let file = {
        use std::os::unix::fs::OpenOptionsExt;
        // Should it have become a link or a pipe meanwhile.
        let flags = rustix::fs::OFlags::NOFOLLOW | rustix::fs::OFlags::NONBLOCK;
        File::options()
            .read(true)
            .custom_flags(flags.bits() as i32)
            .open(path)
    };
    #[cfg(not(unix))]
    let file = File::open(path);
    let file = file.map_err(CityError::file(path))?;
    match file.metadata() {
        Ok(data) if data.is_file() => Ok(file),
        Ok(_) => Err(refused("is no plain file")),
        Err(error) => Err(CityError::file(path)(error)),
    }
}

/// Text of a city's own file.
///
/// # Errors
/// As `open_plain`; when it is longer than `max_bytes` or no UTF-8.
pub fn read_plain_text(path: &Path, max_bytes: u64) -> Result<String, CityError> {
    let mut text = String::new();
    let read = open_plain(path)?.take(max_bytes + 1).read_to_string(&mut text);
    read.map_err(CityError::file(path))?;
    if text.len() as u64 > max_bytes {
        return Err(CityError::File {
            path: path.to_owned(),
            why: format!("has more than {max_bytes} bytes"),
        });
    }
    Ok(text)
}

/// Whether a folder has a manifest that this program wrote, of whatever format.
pub fn is_city(folder: &Path) -> bool {
    let text = read_plain_text(&folder.join("city.toml"), MAX_TEXT).unwrap_or_default();
    let Ok(manifest) = text.parse::<toml::Table>() else {
        return false;
    };
    ["format", "crs", "tile_texels", "grid"]
        .iter()
        .all(|key| manifest.contains_key(*key))
}

/// The city whose folder a path lies in, whether it exists or not.
pub fn enclosing_city(path: &Path) -> Option<PathBuf> {
    let whole = std::path::absolute(path).ok()?;
    // Links in what exists of it lead elsewhere, it may be one itself.
    let real = |path: &Path| fs::canonicalize(path).ok();
    let folder = whole.ancestors().skip(1).find_map(real)?;
    let target = real(&whole);
    let around = target.iter().flat_map(|target| target.ancestors().skip(1));
    folder
        .ancestors()
        .chain(around)
        .find(|folder| is_city(folder))
        .map(Path::to_owned)
}

/// Refuses folders of layers and levels that are links.
///
/// # Errors
/// When one is.
pub fn require_plain_folders(city: &Path, levels: u32) -> Result<(), CityError> {
    for layer in Layer::ALL {
        let folders = (0..levels).map(|level| layer.level_path(city, level));
        for folder in std::iter::once(city.join(layer.name())).chain(folders) {
            match fs::symlink_metadata(&folder) {
                Ok(data) if !data.is_dir() => {
                    return Err(CityError::File {
                        path: folder,
                        why: "is no folder of its own; a city's files lie in its folder".to_owned(),
                    });
                }
                _ => {}
            }
        }
    }
    Ok(())
}

/// The first thing in a city folder that no import or update made, besides `more` names at its top.
///
/// # Errors
/// When a folder cannot be read.
pub fn foreign(folder: &Path, names: &[&str]) -> Result<Option<PathBuf>, CityError> {
    for entry in entries(folder)? {
        let name = entry.file_name();
        // A link would be followed by what reads or replaces the folder's files.
        if entry.file_type().is_ok_and(|kind| kind.is_symlink()) {
            return Ok(Some(entry.path()));
        }
        let layer = Layer::ALL.into_iter().find(|layer| name == layer.name());
        let Some(layer) = layer else {
            if name == PICTURES {
                let is_picture = |name: &str| name.ends_with(".png");
                let pictures = entries(&entry.path())?.into_iter();
                match pictures.into_iter().find(|picture| !is_part(picture, is_picture)) {
                    Some(picture) => return Ok(Some(picture.path())),
                    None => continue,
                }
            }
            let is_ours = names.iter().any(|known| name == **known);
            if is_ours && is_folder(&entry) == FOLDERS.iter().any(|folder| name == **folder) {
                continue;
            }
            return Ok(Some(entry.path()));
        };
        if !is_folder(&entry) {
            return Ok(Some(entry.path()));
        }
        for level in entries(&entry.path())? {
            let is_errors = layer == Layer::Terrain && is_part(&level, |name| name == "errors.tif");
            if is_errors {
                continue;
            }
            let is_level = is_folder(&level) && level.file_name().to_string_lossy().parse::<u32>().is_ok();
            if !is_level {
                return Ok(Some(level.path()));
            }
            for tile in entries(&level.path())? {
                if !is_part(&tile, is_tile_name) {
                    return Ok(Some(tile.path()));
                }
            }
        }
    }
    Ok(None)
}

fn entries(folder: &Path) -> Result<Vec<fs::DirEntry>, CityError> {
    let entries = fs::read_dir(folder).map_err(CityError::file(folder))?;
    entries.collect::<Result<_, _>>().map_err(CityError::file(folder))
}

fn is_folder(entry: &fs::DirEntry) -> bool {
    entry.file_type().is_ok_and(|kind| kind.is_dir())
}

/// Whether an entry is a file of that name, or what is left of its writing.
fn is_part(entry: &fs::DirEntry, is_name: impl Fn(&str) -> bool) -> bool {
    let name = entry.file_name();
    let name = name.to_string_lossy();
    let whole = match name.strip_suffix(".partial") {
        Some(stem) => format!("{stem}.tif"),
        None => name.into_owned(),
    };
    entry.file_type().is_ok_and(|kind| kind.is_file()) && is_name(&whole)
}

/// Whether a file is called like a tile: `X_Y.tif`.
pub fn is_tile_name(name: &str) -> bool {
    tile_place(name).is_some()
}

/// Column and row of a tile by its file's name.
pub fn tile_place(name: &str) -> Option<[u32; 2]> {
    let (x, y) = name.strip_suffix(".tif")?.split_once('_')?;
    Some([x.parse().ok()?, y.parse().ok()?])
}
