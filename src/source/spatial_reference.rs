//! Between GDAL's spatial references, which files carry, and the city's CRS.

use std::ffi::CStr;

use gdal::spatial_ref::{AxisMappingStrategy, SpatialRef};

use crate::space::{Crs, CrsError};

/// Settings by which GDAL asks no server, whatever a file tells it: its requests go to a port where nobody listens. (To skip the drivers of
/// services, as `GDAL_SKIP` does, would be a race between threads in GDAL 3.6: each registration takes them out anew.)
pub const OFFLINE: [(&str, &str); 2] = [
    ("GDAL_HTTP_PROXY", "http://127.0.0.1:9"),
    ("GDAL_HTTPS_PROXY", "http://127.0.0.1:9"),
];

/// GDAL's cache of raster blocks, megabytes.
const CACHE: &str = "GDAL_CACHEMAX";
const CACHE_MB: &str = "384";

/// Sends GDAL's and its PROJ's messages to the log instead of the terminal. Call before anything is read.
pub fn silence_gdal() {
    // By default a twentieth of the machine's memory; huge blocks of rasters would fill it.
    if std::env::var_os(CACHE).is_none() {
        let _ = gdal::config::set_config_option(CACHE, CACHE_MB);
    }
    gdal::config::set_error_handler(|class, number, message| {
        tracing::debug!(?class, number, "gdal: {message}");
    });
}

/// The CRS that GDAL read from a file.
pub fn crs_from_gdal(reference: &SpatialRef) -> Result<Crs, CrsError> {
    let text = wkt2(reference).or_else(|| reference.to_wkt().ok());
    Crs::from_text(&text.unwrap_or_default()).map_err(|error| match error {
        CrsError::Unknown { why, .. } => CrsError::Unknown {
            text: reference.name().unwrap_or_default(),
            why,
        },
        other => other,
    })
}

/// A CRS for GDAL, in easting-northing order.
pub fn gdal_reference(crs: &Crs) -> Result<SpatialRef, CrsError> {
    // By its code a registered CRS keeps the codes of its parts, which its WKT leaves out.
    let reference = match crs.label().starts_with("EPSG:") {
        true => SpatialRef::from_definition(crs.label()),
        false => SpatialRef::from_wkt(crs.wkt()),
    };
    let mut reference = reference.map_err(|error| CrsError::Unknown {
        text: crs.name().to_owned(),
        why: error.to_string(),
    })?;
    reference.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
    Ok(reference)
}

/// ISO 19162:2018: what OSR writes without it (WKT 1) knows neither every system nor every axis order.
fn wkt2(reference: &SpatialRef) -> Option<String> {
    let mut text = std::ptr::null_mut();
    let options = [c"FORMAT=WKT2_2018".as_ptr(), std::ptr::null()];
    // SAFETY: the options end with null; the text is copied before it is freed with GDAL's own function.
    unsafe {
        let status = gdal_sys::OSRExportToWktEx(reference.to_c_hsrs(), &mut text, options.as_ptr());
        let copy = (!text.is_null()).then(|| CStr::from_ptr(text).to_string_lossy().into_owned());
        gdal_sys::VSIFree(text.cast());
        copy.filter(|copy| status == gdal_sys::OGRErr::OGRERR_NONE && !copy.is_empty())
    }
}
