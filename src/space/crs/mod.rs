//! Coordinate reference systems and transformations between them, by PROJ.
//!
//! Axis order is always x = easting or longitude, y = northing or latitude, whatever the authority says.

mod error;
mod geo_area;
mod operation;
mod proj_object;
mod proj_operation;
mod transform;

pub use error::CrsError;
pub use geo_area::GeoArea;
pub use operation::{Accuracy, MissingGrids, Operation, OperationWarning};
pub use transform::PointTransform;

use std::collections::BTreeMap;
use std::sync::Mutex;

use glam::DVec2;

use super::Place;
use proj_object::{ProjObject, Wkt};

/// A horizontal coordinate reference system; a vertical part only leaves its unit behind.
#[derive(Clone, Debug, PartialEq)]
pub struct Crs {
    wkt: String,
    label: String,
    name: String,
    coordinates: Coordinates,
    metres_per_height_unit: Option<f64>,
    /// Where it is used here, which decides between operations.
    area: Option<GeoArea>,
}

/// What the numbers of a CRS are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinates {
    /// Angles on an ellipsoid.
    Geographic {
        radians_per_unit: f64,
        semi_major_m: f64,
    },
    /// Lengths on a map.
    Projected {
        metres_per_unit: f64,
        /// No axis points west or south.
        is_east_north: bool,
        /// Mercator's lengths are true at the equator only.
        is_mercator: bool,
    },
}

/// Definitions that are remembered, at most.
const MAX_KNOWN: usize = 64;

/// Confidence from which PROJ's guess at a registered CRS is believed, percent: same parameters, another name.
const SURE_PERCENT: i32 = 90;

impl Crs {
    /// Whether a definition is a registered code (`EPSG:25832`) or WKT, and names no file or address: what a file from a stranger may give.
    pub fn is_plain_definition(text: &str) -> bool {
        let text = text.trim();
        let is_word = |part: &str, also: &str| {
            !part.is_empty()
                && part
                    .chars()
                    .all(|c| c.is_ascii_alphanumeric() || also.contains(c))
        };
        let is_code = text
            .split_once(':')
            .is_some_and(|(authority, code)| is_word(authority, "_") && is_word(code, "_.-+:"))
            && text.len() <= 64;
        let kind = text.split('[').next().unwrap_or_default();
        let is_wkt = text.contains('[') && text.ends_with(']') && is_word(kind, "_");
        // PROJ takes printed quotation marks for quotes as well; what it writes has none.
        let has_printed_quotes = text.contains(['\u{201c}', '\u{201d}']);
        // Nodes of WKT, and parameters of PROJ in them, that name files. Names and remarks between quotes may be anything.
        let outside_quotes: String = text
            .split('"')
            .step_by(2)
            .collect::<Vec<_>>()
            .join("")
            .to_ascii_uppercase();
        let names_nodes = ["PARAMETERFILE", "EXTENSION"]
            .iter()
            .any(|node| outside_quotes.contains(node));
        let upper = text.to_ascii_uppercase();
        let names_files = ["GRIDS=", "+FILE=", "+MODEL=", "/VSI"]
            .iter()
            .any(|name| upper.contains(name))
            || names_nodes;
        (is_code || is_wkt) && !names_files && !has_printed_quotes
    }

    /// Reads `EPSG:n`, WKT, PROJ strings and whatever else PROJ takes for a CRS; each once, since PROJ opens its database for it.
    pub fn from_text(text: &str) -> Result<Self, CrsError> {
        static KNOWN: Mutex<BTreeMap<String, Crs>> = Mutex::new(BTreeMap::new());
        let definition = text.trim();
        let known = || Some(KNOWN.lock().ok()?.get(definition)?.clone());
        if let Some(known) = known() {
            return Ok(known);
        }
        let crs = Self::defined_by(definition)?;
        if let Ok(mut known) = KNOWN.lock()
            && known.len() < MAX_KNOWN
        {
            known.insert(definition.to_owned(), crs.clone());
        }
        Ok(crs)
    }

    fn defined_by(definition: &str) -> Result<Self, CrsError> {
        let is_proj_string = definition.starts_with('+') || definition.starts_with("proj=");
        let object = if is_proj_string && !definition.contains("type=crs") {
            // Without this PROJ reads an operation.
            ProjObject::from_text(&format!("{definition} +type=crs"))
        } else {
            ProjObject::from_text(definition)
        };
        object
            .and_then(Self::from_object)
            .map_err(|why| CrsError::Unknown {
                text: definition.chars().take(80).collect(),
                why,
            })
    }

    /// Latitude and longitude on WGS 84.
    ///
    /// # Errors
    /// When PROJ does not find its database.
    pub fn wgs84() -> Result<Self, CrsError> {
        Self::from_text("EPSG:4326")
    }

    fn from_object(object: ProjObject) -> Result<Self, String> {
        let mut horizontal = object;
        let mut metres_per_height_unit = None;
        if horizontal.is_compound() {
            let vertical = horizontal.part(1);
            let vertical = vertical.map(|part| part.unbound().unwrap_or(part));
            let axes = vertical.map_or(Vec::new(), |vertical| vertical.axes());
            metres_per_height_unit = axes.first().map(|axis| axis.unit).filter(|metres| *metres > 0.0);
            horizontal = horizontal.part(0).ok_or("it has no horizontal part")?;
        }
        if let Some(registered) = registered(&horizontal) {
            horizontal = registered;
        }
        let unbound = horizontal.is_bound().then(|| horizontal.unbound()).flatten();
        let coordinates = Coordinates::from_object(unbound.as_ref().unwrap_or(&horizontal))?;
        let wkt = horizontal
            .wkt(Wkt::Iso2019)
            .ok_or("it cannot be written as WKT")?;
        let code = horizontal
            .code()
            .or_else(|| unbound.as_ref().and_then(ProjObject::code));
        let label = code.unwrap_or_else(|| wkt.clone());
        let name = if label.len() < 32 {
            label.clone()
        } else {
            let name = horizontal.name();
            name.unwrap_or_else(|| "a CRS without a name".to_owned())
        };
        Ok(Self {
            wkt,
            label,
            name,
            coordinates,
            metres_per_height_unit,
            area: None,
        })
    }

    /// The UTM zone (WGS 84) of a place, degrees.
    pub fn utm_of(longitude_deg: f64, latitude_deg: f64) -> Result<Self, CrsError> {
        let zone = ((longitude_deg + 180.0).rem_euclid(360.0) / 6.0)
            .floor()
            .clamp(0.0, 59.0) as u32
            + 1;
        let base = if latitude_deg < 0.0 { 32700 } else { 32600 };
        Self::from_text(&format!("EPSG:{}", base + zone))
    }

    /// The same, used in one area: operations from it and to it are the best there.
    #[must_use]
    pub fn used_in(&self, area: Option<GeoArea>) -> Self {
        Self { area, ..self.clone() }
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
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its definition as WKT (ISO 19162:2019).
    pub fn wkt(&self) -> &str {
        &self.wkt
    }

    /// Metres per unit of the vertical part, where the CRS had one.
    pub fn metres_per_height_unit(&self) -> Option<f64> {
        self.metres_per_height_unit
    }

    /// Metres per coordinate unit along x and y at a point.
    pub fn metres_per_unit_at(&self, point: DVec2) -> DVec2 {
        match self.coordinates {
            Coordinates::Geographic {
                radians_per_unit,
                semi_major_m,
            } => {
                let metres = semi_major_m * radians_per_unit;
                DVec2::new(metres * (point.y * radians_per_unit).cos(), metres)
            }
            Coordinates::Projected { metres_per_unit, .. } => DVec2::splat(metres_per_unit),
        }
    }

    /// Units of longitude once round the globe; none of a projected CRS.
    pub fn units_a_turn(&self) -> Option<f64> {
        match self.coordinates {
            Coordinates::Geographic { radians_per_unit, .. } => {
                Some(std::f64::consts::TAU / radians_per_unit)
            }
            Coordinates::Projected { .. } => None,
        }
    }

    /// True for lengths in feet, links and their like.
    pub fn has_non_metric_lengths(&self) -> bool {
        matches!(self.coordinates, Coordinates::Projected { metres_per_unit, .. } if !is_metre(metres_per_unit))
    }

    /// WKT in ESRI's dialect, which GeoTIFF readers accept for systems without a code.
    pub fn esri_wkt(&self) -> Result<String, CrsError> {
        self.object()?.wkt(Wkt::Esri).ok_or_else(|| CrsError::Unknown {
            text: self.name.clone(),
            why: "it cannot be written as ESRI's WKT".to_owned(),
        })
    }

    fn object(&self) -> Result<ProjObject, CrsError> {
        ProjObject::from_text(&self.wkt).map_err(|why| CrsError::Unknown {
            text: self.name.clone(),
            why,
        })
    }

    /// True when both describe the same system.
    pub fn same_as(&self, other: &Self) -> bool {
        if self.wkt == other.wkt {
            return true;
        }
        let normalised = |crs: &Self| crs.object().ok()?.normalised();
        normalised(self)
            .zip(normalised(other))
            .is_some_and(|(a, b)| a.is_equivalent(&b))
    }

    /// Refuses what a city cannot be drawn in: degrees, feet, Web Mercator, flipped axes.
    pub fn require_metric(&self) -> Result<(), CrsError> {
        if self.is_metric() {
            return Ok(());
        }
        Err(CrsError::NotMetric {
            crs: self.name.clone(),
        })
    }

    /// True when projected in true metres with axes east and north.
    pub fn is_metric(&self) -> bool {
        matches!(
            self.coordinates,
            Coordinates::Projected { metres_per_unit, is_east_north: true, is_mercator: false } if is_metre(metres_per_unit)
        )
    }

    /// Whether a place lies in the area the CRS is registered for, a degree around it included; true when it names none.
    pub fn is_meant_for(&self, place: &Place) -> bool {
        // The registry knows the area; WKT often leaves it out.
        let registered = ProjObject::from_text(&self.label).ok();
        registered
            .and_then(|object| object.area_of_use())
            .is_none_or(|area| {
                area.grown(1.0)
                    .contains(DVec2::new(place.longitude_deg, place.latitude_deg))
            })
    }

    /// The area of the globe that a rectangle of this CRS covers; none where it lies outside the CRS's own.
    pub fn area_on_globe(&self, min: DVec2, max: DVec2) -> Result<Option<GeoArea>, CrsError> {
        const STEPS: u32 = 8;
        let to_globe = PointTransform::new(self, &Self::from_text("EPSG:4326")?)?;
        let steps = || (0..=STEPS).map(|step| f64::from(step) / f64::from(STEPS));
        let positions = steps().flat_map(|v| steps().map(move |u| DVec2::new(u, v)));
        let points: Vec<DVec2> = positions
            .filter_map(|position| to_globe.point(min + (max - min) * position))
            .collect();
        Ok(GeoArea::from_points(&points))
    }

    /// Where on the globe a point of this CRS lies, and the turn of grid north there
    /// (by a finite difference of one kilometre).
    pub fn place_of(&self, point: DVec2) -> Result<Place, CrsError> {
        let to_globe = PointTransform::new(self, &Self::from_text("EPSG:4326")?)?;
        let no_place = || CrsError::NoTransformation {
            from: self.name.clone(),
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

impl Coordinates {
    /// Angles and angles, or lengths and lengths with axes of the same directions.
    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Geographic { .. }, Self::Geographic { .. }) => true,
            (Self::Projected { is_east_north: a, .. }, Self::Projected { is_east_north: b, .. }) => a == b,
            _ => false,
        }
    }

    fn from_object(crs: &ProjObject) -> Result<Self, String> {
        let axes = crs.axes();
        let unit = axes.first().map_or(0.0, |axis| axis.unit);
        if crs.is_geographic() && unit > 0.0 {
            return Ok(Self::Geographic {
                radians_per_unit: unit,
                semi_major_m: crs.ellipsoid_m().ok_or("it has no ellipsoid")?[0],
            });
        }
        if crs.is_projected() && unit > 0.0 {
            let method = crs.method().unwrap_or_default();
            return Ok(Self::Projected {
                metres_per_unit: unit,
                is_east_north: !axes
                    .iter()
                    .any(|axis| axis.direction == "west" || axis.direction == "south"),
                is_mercator: method.starts_with("Mercator") || method.starts_with("Popular Visualisation"),
            });
        }
        Err("it is neither geographic nor projected".to_owned())
    }
}

fn is_metre(unit: f64) -> bool {
    (unit - 1.0).abs() < 1e-9
}

/// The registered CRS that a code names, whatever names and digits stand beside the code (GDAL reads GeoTIFF keys so too);
/// without a code, as files often are, the one that PROJ is sure is the same.
fn registered(crs: &ProjObject) -> Option<ProjObject> {
    let coordinates = Coordinates::from_object(crs).ok()?;
    let found = match crs.code() {
        Some(code) => ProjObject::from_text(&code).ok()?,
        None => {
            // PROJ recognises WKT where it does not the PROJ string of the same: a label must read back as what it was.
            let crs = ProjObject::from_text(&crs.wkt(Wkt::Iso2019)?).ok()?;
            let (twin, confidence) = crs.matches().into_iter().next()?;
            twin.code().filter(|_| confidence >= SURE_PERCENT)?;
            twin
        }
    };
    let is_like = Coordinates::from_object(&found).is_ok_and(|other| other.is_like(&coordinates));
    is_like.then_some(found)
}
