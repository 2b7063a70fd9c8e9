//! `facades.toml`: the rules that give a city's buildings their facades.

use std::path::Path;

use super::CityError;
use crate::material::FacadeRules;

/// Its name in a city folder.
pub const FACADES: &str = "facades.toml";

/// Most bytes of such a file.
const MAX_BYTES: u64 = 1 << 20;

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
