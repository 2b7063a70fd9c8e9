//! Coordinate reference systems and transformations between them, by GDAL's OSR (PROJ beneath).
//!
//! Axis order is always x = easting or longitude, y = northing or latitude, whatever the
//! authority says (GDAL's "traditional GIS order").

use gdal::spatial_ref::{AxisMappingStrategy, CoordTransform, SpatialRef};
use glam::DVec2;
use thiserror::Error;

use super::Place;

/// Why a coordinate reference system could not be used.
#[derive(Debug, Error)]
pub enum CrsError {
    /// The text names no CRS that PROJ knows.
    #[error("'{text}' is not a coordinate reference system ({why}); give one like EPSG:25832")]
    Unknown {
        /// What was given.
        text: String,
        /// What PROJ said.
        why: String,
    },
    /// The city's CRS must be projected, in metres, east and north.
    #[error(
        "{crs} cannot be a city's CRS: it must be projected, in metres, with axes east and north; give one like EPSG:25832 or the UTM zone of the place"
    )]
    NotMetric {
        /// The CRS's label.
        crs: String,
    },
    /// PROJ finds no way from one to the other.
    #[error("no transformation from {from} to {to}: {why}")]
    NoTransformation {
        /// Source label.
        from: String,
        /// Target label.
        to: String,
        /// What PROJ said.
        why: String,
    },
}

/// A horizontal coordinate reference system; a vertical part only leaves its unit behind.
#[derive(Clone, Debug, PartialEq)]
pub struct Crs {
    wkt: String,
    label: String,
    metres_per_height_unit: Option<f64>,
}

/// Sends GDAL's and PROJ's messages to the log instead of the terminal. Call once at start.
pub fn silence_gdal() {
    gdal::config::set_error_handler(|class, number, message| {
        tracing::debug!(?class, number, "gdal: {message}");
    });
}

impl Crs {
    /// Reads `EPSG:n`, WKT, PROJ strings and whatever else OSR takes.
    pub fn from_text(text: &str) -> Result<Self, CrsError> {
        let definition = text.trim();
        SpatialRef::from_definition(definition)
            .map_err(|error| error.to_string())
            .and_then(|reference| Self::from_gdal(reference).map_err(|error| error.to_string()))
            .map_err(|why| CrsError::Unknown {
                text: definition.chars().take(80).collect(),
                why,
            })
    }

    /// Takes over a CRS that GDAL read from a file.
    pub fn from_gdal(mut reference: SpatialRef) -> Result<Self, CrsError> {
        let metres_per_height_unit = height_unit(&reference);
        if reference.is_compound() {
            // SAFETY: the handle is alive for the call; OSRStripVertical edits it in place.
            unsafe { gdal_sys::OSRStripVertical(reference.to_c_hsrs()) };
        }
        if reference.authority().is_err()
            && let Some(known) = registered_twin(&reference)
        {
            reference = known;
        }
        let unknown = |error: gdal::errors::GdalError| CrsError::Unknown {
            text: reference.name().unwrap_or_default(),
            why: error.to_string(),
        };
        let wkt = reference.to_wkt().map_err(unknown)?;
        let label = reference.authority().unwrap_or_else(|_| wkt.clone());
        Ok(Self {
            wkt,
            label,
            metres_per_height_unit,
        })
    }

    /// The UTM zone (WGS 84) of a place, degrees.
    pub fn utm_of(longitude_deg: f64, latitude_deg: f64) -> Result<Self, CrsError> {
        let zone = ((longitude_deg + 180.0) / 6.0).floor().clamp(0.0, 59.0) as u32 + 1;
        let base = if latitude_deg < 0.0 { 32700 } else { 32600 };
        Self::from_text(&format!("EPSG:{}", base + zone))
    }

    /// `EPSG:n` where the CRS is registered, else its WKT; `from_text` reads either back.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// A label's code, or a word for a long WKT.
    pub fn short_label(label: &str) -> &str {
        if label.starts_with("EPSG:") {
            label
        } else {
            "without a code (WKT in city.toml)"
        }
    }

    /// A short name for messages.
    pub fn name(&self) -> String {
        if self.label.len() < 32 {
            return self.label.clone();
        }
        self.reference()
            .ok()
            .and_then(|reference| reference.name())
            .unwrap_or_else(|| "a CRS without a name".to_owned())
    }

    /// Metres per unit of the vertical part, where the CRS had one.
    pub fn metres_per_height_unit(&self) -> Option<f64> {
        self.metres_per_height_unit
    }

    /// WKT in ESRI's dialect, which GeoTIFF readers accept for systems without a code.
    pub fn esri_wkt(&self) -> Result<String, CrsError> {
        let reference = self.reference()?;
        reference
            .morph_to_esri()
            .and_then(|()| reference.to_wkt())
            .map_err(|error| CrsError::Unknown {
                text: self.label.clone(),
                why: error.to_string(),
            })
    }

    /// A handle for GDAL, in easting-northing order.
    pub fn reference(&self) -> Result<SpatialRef, CrsError> {
        let mut reference = SpatialRef::from_wkt(&self.wkt).map_err(|error| CrsError::Unknown {
            text: self.label.clone(),
            why: error.to_string(),
        })?;
        reference.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
        Ok(reference)
    }

    /// True when both describe the same system.
    pub fn same_as(&self, other: &Self) -> bool {
        self.wkt == other.wkt
            || match (self.reference(), other.reference()) {
                (Ok(a), Ok(b)) => a == b,
                _ => false,
            }
    }

    /// Refuses what a city cannot be drawn in: degrees, feet, Web Mercator, flipped axes.
    pub fn require_metric(&self) -> Result<(), CrsError> {
        if self.is_metric()? {
            return Ok(());
        }
        Err(CrsError::NotMetric { crs: self.name() })
    }

    /// True when projected in true metres with axes east and north.
    pub fn is_metric(&self) -> Result<bool, CrsError> {
        use gdal_sys::OGRAxisOrientation as axis_orientation;
        let reference = self.reference()?;
        let projection = reference
            .get_attr_value("PROJECTION", 0)
            .ok()
            .flatten()
            .unwrap_or_default();
        let distorted = projection.starts_with("Mercator");
        let flipped = (0..2).any(|axis| {
            reference
                .axis_orientation("PROJCS", axis)
                .is_ok_and(|orientation| {
                    orientation == axis_orientation::OAO_West || orientation == axis_orientation::OAO_South
                })
        });
        let metres = (reference.linear_units() - 1.0).abs() < 1e-9;
        Ok(reference.is_projected() && metres && !distorted && !flipped)
    }

    /// Whether a place lies in the area the CRS is registered for, a degree around it included; true when it names none.
    pub fn is_meant_for(&self, place: &Place) -> bool {
        // The registry knows the area; WKT often leaves it out.
        let Some(area) = SpatialRef::from_definition(&self.label)
            .ok()
            .and_then(|reference| reference.area_of_use())
        else {
            return true;
        };
        let (west, east) = (area.west_lon_degree - 1.0, area.east_lon_degree + 1.0);
        // An area over the date line ends at a smaller longitude than it begins.
        let longitude = place.longitude_deg;
        let along = if west < east {
            (west..=east).contains(&longitude)
        } else {
            longitude >= west || longitude <= east
        };
        let latitudes = area.south_lat_degree - 1.0..=area.north_lat_degree + 1.0;
        along && latitudes.contains(&place.latitude_deg)
    }

    /// Where on the globe a point of this CRS lies, and the turn of grid north there
    /// (by a finite difference of one kilometre).
    pub fn place_of(&self, point: DVec2) -> Result<Place, CrsError> {
        let to_globe = PointTransform::new(self, &Self::from_text("EPSG:4326")?)?;
        let no_place = || CrsError::NoTransformation {
            from: self.name(),
            to: "EPSG:4326".to_owned(),
            why: "the city's centre lies outside the CRS's area".to_owned(),
        };
        let here = to_globe.point(point).ok_or_else(no_place)?;
        let north = to_globe
            .point(point + DVec2::new(0.0, 1000.0))
            .ok_or_else(no_place)?;
        let east_step = (north.x - here.x) * here.y.to_radians().cos();
        Ok(Place {
            latitude_deg: here.y,
            longitude_deg: here.x,
            grid_north_deg: east_step.atan2(north.y - here.y).to_degrees(),
        })
    }
}

fn height_unit(reference: &SpatialRef) -> Option<f64> {
    if !reference.is_compound() {
        return None;
    }
    let unit = reference.get_attr_value("COMPD_CS|VERT_CS|UNIT", 1).ok()??;
    unit.parse().ok().filter(|metres: &f64| *metres > 0.0)
}

/// The registered CRS that PROJ is at least 90 % sure is the same (files often carry no code).
fn registered_twin(reference: &SpatialRef) -> Option<SpatialRef> {
    let mut count = 0;
    let mut confidence: *mut std::ffi::c_int = std::ptr::null_mut();
    // SAFETY: the matches are cloned before GDAL's list is freed; null lists are checked.
    unsafe {
        let matches = gdal_sys::OSRFindMatches(
            reference.to_c_hsrs(),
            std::ptr::null_mut(),
            &mut count,
            &mut confidence,
        );
        let best = (!matches.is_null() && count > 0 && *confidence >= 90)
            .then(|| SpatialRef::from_c_obj(*matches).ok())
            .flatten();
        if !matches.is_null() {
            gdal_sys::OSRFreeSRSArray(matches);
        }
        if !confidence.is_null() {
            gdal_sys::VSIFree(confidence.cast());
        }
        best.filter(|found| found.is_geographic() == reference.is_geographic())
    }
}

/// A transformation of points; one per thread.
pub struct PointTransform {
    inner: Option<CoordTransform>,
}

impl PointTransform {
    /// From one CRS to another; the identity costs nothing and changes no bit.
    pub fn new(from: &Crs, to: &Crs) -> Result<Self, CrsError> {
        if from.same_as(to) {
            return Ok(Self { inner: None });
        }
        let inner = CoordTransform::new(&from.reference()?, &to.reference()?).map_err(|error| {
            CrsError::NoTransformation {
                from: from.name(),
                to: to.name(),
                why: error.to_string(),
            }
        })?;
        Ok(Self { inner: Some(inner) })
    }

    /// True when points stay where they are.
    pub fn is_identity(&self) -> bool {
        self.inner.is_none()
    }

    /// Transforms in place; points that PROJ cannot take become NaN.
    pub fn points(&self, xs: &mut [f64], ys: &mut [f64]) {
        let Some(inner) = &self.inner else { return };
        // GDAL transforms what it can, marks the rest with infinity and then reports an error.
        if let Err(error) = inner.transform_coords(xs, ys, &mut []) {
            tracing::debug!("points outside the CRS: {error}");
        }
        for (x, y) in xs.iter_mut().zip(ys.iter_mut()) {
            if !x.is_finite() || !y.is_finite() {
                (*x, *y) = (f64::NAN, f64::NAN);
            }
        }
    }

    /// Transforms one point; none when PROJ cannot.
    pub fn point(&self, point: DVec2) -> Option<DVec2> {
        let (mut x, mut y) = ([point.x], [point.y]);
        self.points(&mut x, &mut y);
        (x[0].is_finite()).then(|| DVec2::new(x[0], y[0]))
    }
}
