//! Opens a lens by name or file.

use std::path::Path;

use super::{BUILT_IN, Lens, LensError, built_in, codev, csv, pbrt, table, zemax};

/// Largest prescription file that is read: a table of surfaces is a few kilobytes.
const MAX_BYTES: u64 = 16 << 20;

/// A built-in name, or a file by its ending.
///
/// # Errors
/// See [`LensError`].
pub fn open(name: &str) -> Result<Lens, LensError> {
    if let Some(lens) = built_in(name) {
        return lens;
    }
    let path = Path::new(name);
    if !path.exists() {
        return Err(LensError::Unknown {
            name: name.to_owned(),
            known: BUILT_IN.map(|(name, _)| name).join(", "),
        });
    }
    let read = |source| LensError::Read {
        path: path.to_owned(),
        source,
    };
    let data = std::fs::metadata(path).map_err(read)?;
    if !data.is_file() {
        return Err(LensError::Syntax {
            path: path.to_owned(),
            what: "is no plain file; give a file with a lens prescription".to_owned(),
        });
    }
    let size = data.len();
    if size > MAX_BYTES {
        return Err(LensError::Syntax {
            path: path.to_owned(),
            what: format!("{size} bytes are too many for a lens prescription"),
        });
    }
    let text = text_of(&std::fs::read(path).map_err(read)?);
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    let lens = match ending.as_deref() {
        Some("toml") => table::read(path, &text),
        Some("csv") => csv::read(path, &text),
        Some("zmx") => zemax::read(path, &text),
        Some("seq") => codev::read(path, &text),
        Some("dat") => pbrt::read(path, &text),
        _ => Err(LensError::Format {
            path: path.to_owned(),
        }),
    };
    // The message names the file, not the title in it.
    lens.map_err(|error| match error {
        LensError::Unfit { what, .. } => LensError::Unfit {
            name: path.display().to_string(),
            what,
        },
        other => other,
    })
}

/// Text in UTF-16 (either order, told by its mark or by its zeros), UTF-8, or else Latin-1; lines may end the way of old
/// Macintoshes.
fn text_of(bytes: &[u8]) -> String {
    decoded(bytes).replace("\r\n", "\n").replace('\r', "\n")
}

fn decoded(bytes: &[u8]) -> String {
    let utf16 = |first: usize, pair: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes[first..]
            .as_chunks::<2>()
            .0
            .iter()
            .map(|&two| pair(two))
            .collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xff, 0xfe, ..] => utf16(2, u16::from_le_bytes),
        [0xfe, 0xff, ..] => utf16(2, u16::from_be_bytes),
        [1..=255, 0, 1..=255, 0, ..] => utf16(0, u16::from_le_bytes),
        [0, 1..=255, 0, 1..=255, ..] => utf16(0, u16::from_be_bytes),
        _ => String::from_utf8(bytes.to_vec()).map_or_else(
            |_| bytes.iter().map(|&byte| char::from(byte)).collect(),
            |text| text.trim_start_matches('\u{feff}').to_owned(),
        ),
    }
}
