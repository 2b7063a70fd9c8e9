//! What an import notices that is no error. What a command can be told to mend it is the command line's to say
//! (`cli::advice`).

use std::fmt;
use std::path::{Path, PathBuf};

use super::sources::Sources;
use crate::city::CityError;
use crate::source::{SourceRole, SteppedHeights};
use crate::space::{Bounds, Crs, OperationWarning, Place};

/// Something that the user should know.
#[derive(Clone, Debug, PartialEq)]
pub enum ImportWarning {
    /// Files that show another place.
    Outside {
        /// The files.
        files: Vec<PathBuf>,
        /// What they were given as.
        role: SourceRole,
    },
    /// Terrain files that may be in feet.
    UnspecifiedUnit {
        /// The files.
        files: Vec<PathBuf>,
    },
    /// The city lies outside the area of use of its CRS.
    OutsideCrs {
        /// Where the city lies.
        place: Place,
        /// Name of its CRS.
        crs: String,
    },
    /// A CityJSON of whole coordinates that still gives a translation.
    TranslationDropped {
        /// The file.
        file: PathBuf,
    },
    /// Heights in whole steps that show as terraces.
    Steps {
        /// Where.
        stepped: SteppedHeights,
        /// Whether they are kept as they are.
        kept: bool,
    },
    /// Wider holes were to be filled than a tile's neighbourhood holds.
    FillCut {
        /// Widest that is filled, metres.
        filled_m: f64,
    },
    /// Coordinates may lie off by more than they need.
    Operation(OperationWarning),
    /// No field was named and none has a known name.
    NoHeights {
        /// The height that every building gets, metres.
        default_height_m: f64,
        /// The fields there are.
        fields: Vec<String>,
    },
}

impl fmt::Display for ImportWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let about = |f: &mut fmt::Formatter<'_>, files: &[PathBuf], what: &str| match files {
            [] => Ok(()),
            [file] => write!(f, "{} {what}", file.display()),
            [first, rest @ ..] => write!(f, "{} and {} more: each {what}", first.display(), rest.len()),
        };
        match self {
            Self::Outside { files, .. } => about(f, files, "lies outside the city and is not used"),
            Self::UnspecifiedUnit { files } => about(
                f,
                files,
                "is in a CRS that is not in metres and does not name the unit of its heights: read as metres",
            ),
            Self::OutsideCrs { place, crs } => write!(
                f,
                "the city lies at {:.3} degrees east, {:.3} north, outside the area that {crs} is made for: lengths and \
                 north may be far off",
                place.longitude_deg, place.latitude_deg
            ),
            Self::TranslationDropped { file } => write!(
                f,
                "{}: its vertices lie in its own extent only without its translation, which is dropped",
                file.display()
            ),
            Self::Steps { stepped, kept } => {
                let files = match stepped.files {
                    1 => String::new(),
                    count => format!(" and {} more", count - 1),
                };
                write!(
                    f,
                    "{}{files}: heights in whole steps of {} m on pixels of {} m show as terraces: ",
                    stepped.path.display(),
                    stepped.step_m,
                    stepped.pixel_m,
                )?;
                if *kept {
                    f.write_str("kept as they are")
                } else {
                    write!(f, "smoothed within {} m", 0.5 * stepped.step_m)
                }
            }
            Self::FillCut { filled_m } => write!(
                f,
                "holes are filled up to {filled_m:.0} m only, at this spacing of the terrain"
            ),
            Self::Operation(warning) => warning.fmt(f),
            Self::NoHeights { default_height_m, .. } => write!(
                f,
                "no field of a known name gives heights: every building is {default_height_m} m high"
            ),
        }
    }
}

/// About the sources and where they lie; `city` is the rectangle of the city's tiles, `place` its centre.
pub fn source_warnings(
    sources: &Sources,
    keep_steps: bool,
    city: &Bounds,
    place: &Place,
) -> Result<Vec<ImportWarning>, CityError> {
    let owned = |files: Vec<&Path>| files.into_iter().map(Path::to_owned).collect::<Vec<_>>();
    let mut warnings = Vec::new();
    let mut outside = vec![(
        owned(sources.dtm.files_outside(&sources.crs, city)?),
        SourceRole::Terrain,
    )];
    if let Some(imagery) = &sources.imagery {
        outside.push((owned(imagery.files_outside(city).collect()), SourceRole::Imagery));
    }
    for (files, role) in outside {
        if !files.is_empty() {
            warnings.push(ImportWarning::Outside { files, role });
        }
    }
    let files = owned(sources.dtm.files_of_unspecified_unit().collect());
    if !files.is_empty() {
        warnings.push(ImportWarning::UnspecifiedUnit { files });
    }
    warnings.extend(sources.stepped.iter().map(|stepped| ImportWarning::Steps {
        stepped: stepped.clone(),
        kept: keep_steps,
    }));
    if sources.buildings.translation_dropped {
        let file = sources.buildings.path().to_owned();
        warnings.push(ImportWarning::TranslationDropped { file });
    }
    if !sources.crs.is_meant_for(place) {
        warnings.push(ImportWarning::OutsideCrs {
            place: *place,
            crs: Crs::short_label(sources.crs.label()).to_string(),
        });
    }
    Ok(warnings)
}
