//! What an import notices that is no error: sentences, each with what to do.

use std::path::Path;

use super::sources::Sources;
use crate::city::CityError;
use crate::space::{Bounds, Crs, Place};

/// About the sources and where they lie; `city` is the rectangle of the city's tiles, `place` its centre.
pub fn source_warnings(
    sources: &Sources,
    keep_steps: bool,
    city: &Bounds,
    place: &Place,
) -> Result<Vec<String>, CityError> {
    let mut warnings = Vec::new();
    let about = |files: &[&Path], what: &str| {
        let first = files.first()?.display();
        Some(match files.len() {
            1 => format!("{first} {what}"),
            count => format!("{first} and {} more: each {what}", count - 1),
        })
    };
    let apart = sources.dtm.files_outside(&sources.crs, city)?;
    warnings.extend(about(
        &apart,
        "lies outside the city and is not used: check its place, or leave it out",
    ));
    let unspecified: Vec<&Path> = sources.dtm.files_of_unspecified_unit().collect();
    warnings.extend(about(
        &unspecified,
        "is in a CRS that is not in metres and does not name the unit of its heights: read as metres; \
         if they are feet, give --terrain-unit 0.3048 (US survey feet: 0.3048006)",
    ));
    for stepped in &sources.stepped {
        let files = match stepped.files {
            1 => String::new(),
            count => format!(" and {} more", count - 1),
        };
        warnings.push(format!(
            "{}{files}: heights in whole steps of {} m on pixels of {} m show as terraces: {}",
            stepped.path.display(),
            stepped.step_m,
            stepped.pixel_m,
            if keep_steps {
                "kept as they are".to_owned()
            } else {
                format!(
                    "smoothed within {} m; --keep-steps keeps them",
                    0.5 * stepped.step_m
                )
            }
        ));
    }
    if let Some(imagery) = &sources.imagery {
        let apart: Vec<&Path> = imagery.files_outside(city).collect();
        warnings.extend(about(
            &apart,
            "lies outside the city and is not used: check its place and --photo-crs, or leave it out",
        ));
    }
    if !sources.crs.is_meant_for(place) {
        warnings.push(format!(
            "the city lies at {:.3} degrees east, {:.3} north, outside the area that {} is made for: lengths and north may \
             be far off; give another --crs",
            place.longitude_deg,
            place.latitude_deg,
            Crs::short_label(sources.crs.label())
        ));
    }
    Ok(warnings)
}
