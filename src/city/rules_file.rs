//! `facades.toml`: the rules that give a city's buildings their facades.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use super::CityError;
use super::city_files::{PICTURES, open_plain};
use crate::material::{Canvas, FacadeRules, OwnFacade, OwnTiles, facade_from_picture};

/// Its name in a city folder.
pub const FACADES: &str = "facades.toml";

/// Rules that somebody edited and an import with other ones replaced.
pub const FACADES_BEFORE: &str = "facades.before.toml";

/// Most bytes of such a file, and of a picture.
const MAX_BYTES: u64 = 1 << 20;
const MAX_PICTURE_BYTES: u64 = 16 << 20;

/// The rules of a city folder and their text: the project's own where it has none.
///
/// # Errors
/// When they cannot be read or used.
pub fn rules_from_city(city: &Path) -> Result<(FacadeRules, String), CityError> {
    let path = city.join(FACADES);
    match std::fs::symlink_metadata(&path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            Ok((FacadeRules::default(), FacadeRules::BUILT_IN.to_owned()))
        }
        _ => read_rules(&path),
    }
}

/// Reads a file of rules, and its text.
///
/// # Errors
/// When it cannot be read or used.
pub fn read_rules(path: &Path) -> Result<(FacadeRules, String), CityError> {
    let refused = |why: String| CityError::Rules {
        path: path.to_owned(),
        why,
    };
    let text = match std::fs::symlink_metadata(path) {
        Err(error) => return Err(refused(error.to_string())),
        // A link could lead the reader out of the folder.
        Ok(data) if !data.is_file() || data.len() > MAX_BYTES => {
            return Err(refused("it is no plain file of at most a megabyte".to_owned()));
        }
        Ok(_) => std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?,
    };
    let rules = FacadeRules::from_text(&text).map_err(|error| refused(error.to_string()))?;
    Ok((rules, text))
}

/// Names and bytes of the pictures that rules name, out of the folder beside their file.
///
/// # Errors
/// When one cannot be read.
pub fn pictures(beside: &Path, rules: &FacadeRules) -> Result<BTreeMap<String, Vec<u8>>, CityError> {
    let mut pictures = BTreeMap::new();
    let folder = beside.join(PICTURES);
    // A link could lead the reader out of the city.
    let is_plain = std::fs::symlink_metadata(&folder).is_ok_and(|data| data.is_dir());
    if !rules.own_facades().is_empty() && !is_plain {
        return Err(CityError::File {
            path: folder,
            why: "is no folder; the pictures that the rules for facades name lie in it".to_owned(),
        });
    }
    for name in rules.own_facades().iter().flat_map(OwnFacade::pictures) {
        if pictures.contains_key(name) {
            continue;
        }
        let path = folder.join(name);
        let mut bytes = Vec::new();
        let mut file = open_plain(&path)?.take(MAX_PICTURE_BYTES + 1);
        file.read_to_end(&mut bytes).map_err(CityError::file(&path))?;
        if bytes.len() as u64 > MAX_PICTURE_BYTES {
            return Err(CityError::File {
                path,
                why: format!("has more than {MAX_PICTURE_BYTES} bytes"),
            });
        }
        // Refused here, not by the first frame.
        tile(&path, &bytes, [1.0; 2])?;
        pictures.insert(name.to_owned(), bytes);
    }
    Ok(pictures)
}

/// Writes such pictures beside a city's rules.
///
/// # Errors
/// When one cannot be written.
pub fn write_pictures(city: &Path, pictures: &BTreeMap<String, Vec<u8>>) -> Result<(), CityError> {
    let folder = city.join(PICTURES);
    if !pictures.is_empty() {
        std::fs::create_dir_all(&folder).map_err(CityError::file(&folder))?;
    }
    for (name, bytes) in pictures {
        let path = folder.join(name);
        std::fs::write(&path, bytes).map_err(CityError::file(&path))?;
    }
    Ok(())
}

/// Copies the pictures of a city's folder that are not in another one's yet: the user's own, for rules to come.
///
/// # Errors
/// When one cannot be copied.
pub fn keep_pictures(from: &Path, to: &Path) -> Result<(), CityError> {
    let [from, to] = [from, to].map(|city| city.join(PICTURES));
    // A link could lead the reader out of the city.
    let is_plain = std::fs::symlink_metadata(&from).is_ok_and(|data| data.is_dir());
    let Some(entries) = is_plain.then(|| std::fs::read_dir(&from).ok()).flatten() else {
        return Ok(());
    };
    for entry in entries.flatten() {
        let place = to.join(entry.file_name());
        if entry.file_type().is_ok_and(|kind| kind.is_file()) && !place.exists() {
            let copied = std::fs::create_dir_all(&to).and_then(|()| std::fs::copy(entry.path(), &place));
            copied.map_err(CityError::file(&place))?;
        }
    }
    Ok(())
}

fn tile(path: &Path, bytes: &[u8], size_m: [f64; 2]) -> Result<Canvas, CityError> {
    facade_from_picture(bytes, size_m).map_err(|why| CityError::File {
        path: path.to_owned(),
        why: format!("is no PNG picture of a facade ({why})"),
    })
}

/// The tiles of the user's own facades; `beside`: the folder of the file of rules.
///
/// # Errors
/// When a picture cannot be read.
pub fn own_tiles(beside: &Path, rules: &FacadeRules) -> Result<Vec<OwnTiles>, CityError> {
    let pictures = pictures(beside, rules)?;
    let own = rules.own_facades().iter();
    own.map(|own| {
        let [a, b, c, d] = own.pictures().map(|name| {
            let bytes = pictures.get(name).map_or(&[][..], Vec::as_slice);
            tile(
                &beside.join(PICTURES).join(name),
                bytes,
                [2.0 * own.bay_m, own.storey_m],
            )
        });
        Ok(OwnTiles {
            bands: [a?, b?, c?, d?],
            bay_m: own.bay_m,
        })
    })
    .collect()
}
