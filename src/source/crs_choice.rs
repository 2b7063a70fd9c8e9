//! Which CRS a source file is in: what the user says, else what the file says, else the city's.

use std::path::Path;

use gdal::spatial_ref::SpatialRef;

use super::spatial_reference::crs_from_gdal;
use super::{SourceError, SourceRole};
use crate::space::Crs;

/// How to decide a file's CRS.
#[derive(Clone, Debug)]
pub struct CrsChoice {
    /// Overrides what the files say (some say wrong things, and GeoJSON cannot say anything).
    given: Option<Crs>,
    /// Serves files that name none.
    fallback: Option<Crs>,
}

impl CrsChoice {
    /// `given` by a flag of its own, `fallback` from the city.
    pub fn new(given: Option<Crs>, fallback: Option<&Crs>) -> Self {
        Self {
            given,
            fallback: fallback.cloned(),
        }
    }

    /// The CRS of a file that names `own`; `role` is what the file was given as.
    pub fn of_file(
        &self,
        path: &Path,
        own: Option<SpatialRef>,
        role: SourceRole,
    ) -> Result<Crs, SourceError> {
        if let Some(given) = &self.given {
            return Ok(given.clone());
        }
        let Some(own) = own.filter(|reference| !reference.is_local()) else {
            return self.fallback.clone().ok_or_else(|| SourceError::NoCrs {
                path: path.to_owned(),
                role,
            });
        };
        crs_from_gdal(&own).map_err(|source| SourceError::Crs {
            path: path.to_owned(),
            source,
        })
    }
}
