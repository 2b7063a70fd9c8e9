//! A building as the footprint dataset knows it: an outline and one number for its roof.

use geo::MultiPolygon;
use serde::{Deserialize, Serialize};

/// One footprint in the city's CRS. Outer rings run counter-clockwise, holes clockwise, so the
/// building is always to the left of its outline.
#[derive(Clone, Debug)]
pub struct Footprint {
    /// The feature's place in the source, from 1.
    pub fid: u32,
    /// Outer rings and holes, metres.
    pub outline: MultiPolygon<f64>,
    /// How high it is.
    pub roof: RoofSpec,
    /// Why it has the default height, when it has.
    pub default_height: Option<&'static str>,
}

/// What the map says of the roof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RoofSpec {
    /// Metres above the lowest ground at the outline's vertices.
    HeightAboveBase(f64),
    /// Metres above the vertical datum.
    Elevation(f64),
}

/// Which attribute gives the roof.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "from")]
pub enum HeightRule {
    /// Every building has the default height.
    Default,
    /// A field with the height above ground, metres.
    Height {
        /// Field name.
        field: String,
    },
    /// A field with the number of storeys.
    Storeys {
        /// Field name.
        field: String,
        /// Height of a storey, metres.
        storey_height_m: f64,
    },
    /// A field with the roof's absolute elevation, metres.
    RoofElevation {
        /// Field name.
        field: String,
    },
}

impl HeightRule {
    /// The field it reads, if any.
    pub fn field(&self) -> Option<&str> {
        match self {
            Self::Default => None,
            Self::Height { field } | Self::Storeys { field, .. } | Self::RoofElevation { field } => {
                Some(field)
            }
        }
    }

    /// The roof from the field's text; none when the text is missing or not a usable number
    /// (heights and storeys must be above zero).
    pub fn roof_from_text(&self, text: Option<&str>) -> Option<RoofSpec> {
        let counts_storeys = matches!(self, Self::Storeys { .. });
        let metres = number_from_text(
            text?,
            if counts_storeys {
                &STOREY_UNITS
            } else {
                &LENGTH_UNITS
            },
        )?;
        let roof = match self {
            Self::Default => None,
            Self::Height { .. } => (metres > 0.0).then_some(RoofSpec::HeightAboveBase(metres)),
            Self::Storeys { storey_height_m, .. } => {
                (metres > 0.0).then_some(RoofSpec::HeightAboveBase(metres * storey_height_m))
            }
            Self::RoofElevation { .. } => Some(RoofSpec::Elevation(metres)),
        };
        roof.filter(
            |(RoofSpec::HeightAboveBase(metres) | RoofSpec::Elevation(metres))| metres.abs() < HIGHEST_M,
        )
    }
}

/// Highest believable height or elevation, metres; beyond it lie sentinels such as 9999.
const HIGHEST_M: f64 = 9_000.0;

/// What may stand behind a length, and its metres.
const LENGTH_UNITS: [(&str, f64); 9] = [
    ("", 1.0),
    ("m", 1.0),
    ("m.", 1.0),
    ("metres", 1.0),
    ("meters", 1.0),
    ("ft", 0.3048),
    ("feet", 0.3048),
    ("foot", 0.3048),
    ("'", 0.3048),
];

/// What may stand behind a number of storeys.
const STOREY_UNITS: [(&str, f64); 5] = [
    ("", 1.0),
    ("storeys", 1.0),
    ("stories", 1.0),
    ("floors", 1.0),
    ("levels", 1.0),
];

/// A number as people write it (`12`, `12.5 m`, `12,5`, `40 ft`, `3 storeys`) in the first of `units`; none for
/// anything else.
fn number_from_text(text: &str, units: &[(&str, f64)]) -> Option<f64> {
    let text = text.trim().replace(',', ".");
    let end = text
        .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e' | 'E')))
        .unwrap_or(text.len());
    let number: f64 = text[..end].parse().ok()?;
    let word = text[end..].trim().to_lowercase();
    let (_, factor) = units.iter().find(|(unit, _)| *unit == word)?;
    let value = number * factor;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_people_write_are_read() {
        for (text, metres) in [
            ("12", Some(12.0)),
            ("12.5 m", Some(12.5)),
            ("12,5", Some(12.5)),
            (" 40 ft", Some(40.0 * 0.3048)),
            ("40'", Some(40.0 * 0.3048)),
            ("-3", Some(-3.0)),
            ("2;3", None),
            ("unknown", None),
            ("", None),
            ("3 floors", None),
            ("nan", None),
            ("1e400", None),
        ] {
            assert_eq!(number_from_text(text, &LENGTH_UNITS), metres, "{text:?}");
        }
    }

    #[test]
    fn zero_and_negative_heights_are_no_heights_but_roof_elevations_may_be() {
        let height = HeightRule::Height {
            field: "h".to_owned(),
        };
        assert_eq!(height.roof_from_text(Some("0")), None);
        assert_eq!(height.roof_from_text(Some("-2")), None);
        assert_eq!(height.roof_from_text(Some("9999")), None, "a sentinel");
        let storeys = HeightRule::Storeys {
            field: "n".to_owned(),
            storey_height_m: 3.0,
        };
        assert_eq!(
            storeys.roof_from_text(Some("3 floors")),
            Some(RoofSpec::HeightAboveBase(9.0))
        );
        assert_eq!(storeys.roof_from_text(Some("40 ft")), None);
        let roof = HeightRule::RoofElevation {
            field: "z".to_owned(),
        };
        assert_eq!(roof.roof_from_text(Some("-2")), Some(RoofSpec::Elevation(-2.0)));
    }
}
