//! The lenses that come with the program: `data/lenses/*.toml`, where each names its patent.

use std::path::Path;

use super::{Lens, LensError, table};

macro_rules! file {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/data/lenses/",
                $name,
                ".toml"
            )),
        )
    };
}

/// Name and text of each.
pub const BUILT_IN: [(&str, &str); 8] = [
    file!("heliar"),
    file!("heliar-example-1"),
    file!("tessar"),
    file!("triplet"),
    file!("angenieux"),
    file!("nikon"),
    file!("itoh"),
    file!("canon"),
];

/// A built-in lens by name; none when there is none of that name.
pub fn built_in(name: &str) -> Option<Result<Lens, LensError>> {
    let (name, text) = BUILT_IN.iter().find(|(known, _)| *known == name)?;
    Some(table::read(Path::new(name), text))
}
