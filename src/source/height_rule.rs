//! Which attributes give a building's height, and how they are read.

use serde::{Deserialize, Serialize};

use super::RoofSpec;
use super::height_text::{FOOT_M, length_from_text, storeys_from_text};

/// Which attributes give the roof. Kept in the city's manifest, so that its footprint dataset gives the same heights again.
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
    /// Fields of known names: for each building the first that holds a usable value.
    KnownFields {
        /// The fields, best first.
        fields: Vec<HeightField>,
    },
}

/// One attribute and what it means.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeightField {
    /// Field name, or key of OSM's `other_tags`.
    pub field: String,
    /// How it is read.
    #[serde(flatten)]
    pub reading: HeightReading,
}

/// How an attribute is read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "as")]
pub enum HeightReading {
    /// Height above ground.
    Height {
        /// Metres in a unit of a number without one.
        unit_m: f64,
    },
    /// Number of storeys.
    Storeys {
        /// Field with storeys to be added (OSM counts those under the roof apart).
        #[serde(skip_serializing_if = "Option::is_none")]
        plus: Option<String>,
        /// Height of a storey, metres.
        storey_height_m: f64,
    },
    /// Elevation of the roof, to be lessened by that of the ground in another field; both metres.
    RoofLessGround {
        /// Field of the ground.
        ground: String,
    },
    /// Elevation of the roof above the vertical datum, metres.
    RoofElevation,
}

/// Greatest believable height, metres; beyond it lie sentinels such as 9999.
const MAX_HEIGHT_M: f64 = 1_000.0;

/// Greatest believable elevation of a roof, metres.
const MAX_ELEVATION_M: f64 = 9_000.0;

impl HeightRule {
    /// The fields it reads, best first.
    pub fn fields(&self) -> Vec<HeightField> {
        let one = |field: &String, reading| {
            vec![HeightField {
                field: field.clone(),
                reading,
            }]
        };
        match self {
            Self::Default => Vec::new(),
            Self::Height { field } => one(field, HeightReading::Height { unit_m: 1.0 }),
            Self::Storeys {
                field,
                storey_height_m,
            } => one(
                field,
                HeightReading::Storeys {
                    plus: None,
                    storey_height_m: *storey_height_m,
                },
            ),
            Self::RoofElevation { field } => one(field, HeightReading::RoofElevation),
            Self::KnownFields { fields } => fields.clone(),
        }
    }

    /// True when the user named the field: it must exist.
    pub fn is_given(&self) -> bool {
        matches!(
            self,
            Self::Height { .. } | Self::Storeys { .. } | Self::RoofElevation { .. }
        )
    }
}

impl HeightField {
    /// The second field that it needs or takes into account.
    pub fn companion(&self) -> Option<&str> {
        match &self.reading {
            HeightReading::Storeys { plus, .. } => plus.as_deref(),
            HeightReading::RoofLessGround { ground } => Some(ground),
            HeightReading::Height { .. } | HeightReading::RoofElevation => None,
        }
    }

    /// The roof from the field's text and its companion's; none when the text is not a usable number: heights and
    /// storeys must be above zero, heights at most a kilometre.
    pub fn roof_from_text(&self, text: &str, companion: Option<&str>) -> Option<RoofSpec> {
        let height = |metres: f64| {
            (metres > 0.0 && metres <= MAX_HEIGHT_M).then_some(RoofSpec::HeightAboveBase(metres))
        };
        match &self.reading {
            HeightReading::Height { unit_m } => height(length_from_text(text, *unit_m)?),
            HeightReading::Storeys { storey_height_m, .. } => {
                let storeys = storeys_from_text(text).filter(|&storeys| storeys > 0.0)?;
                let under_roof = companion.and_then(storeys_from_text).unwrap_or(0.0).max(0.0);
                height((storeys + under_roof) * storey_height_m)
            }
            HeightReading::RoofLessGround { .. } => {
                let [roof, ground] = [text, companion?].map(|text| length_from_text(text, 1.0));
                height(roof? - ground?)
            }
            HeightReading::RoofElevation => length_from_text(text, 1.0)
                .filter(|metres| metres.abs() <= MAX_ELEVATION_M)
                .map(RoofSpec::Elevation),
        }
    }
}

impl std::fmt::Display for HeightField {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let field = &self.field;
        match &self.reading {
            HeightReading::Height { unit_m } if *unit_m == 1.0 => write!(f, "\"{field}\" (metres)"),
            HeightReading::Height { unit_m } if *unit_m == FOOT_M => write!(f, "\"{field}\" (feet)"),
            HeightReading::Height { unit_m } => write!(f, "\"{field}\" x {unit_m} m"),
            HeightReading::Storeys {
                plus: Some(plus),
                storey_height_m,
            } => write!(f, "\"{field}\" (+ \"{plus}\") x {storey_height_m} m"),
            HeightReading::Storeys {
                plus: None,
                storey_height_m,
            } => write!(f, "\"{field}\" x {storey_height_m} m"),
            HeightReading::RoofLessGround { ground } => write!(f, "\"{field}\" - \"{ground}\" (metres)"),
            HeightReading::RoofElevation => write!(f, "\"{field}\" (roof elevation, metres)"),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn roof(rule: HeightRule, text: &str) -> Option<RoofSpec> {
        rule.fields()[0].roof_from_text(text, None)
    }

    #[test]
    fn zero_and_negative_heights_are_no_heights_but_roof_elevations_may_be() {
        let height = |text| {
            let field = "h".to_owned();
            roof(HeightRule::Height { field }, text)
        };
        for nonsense in ["0", "-1", "-2", "1001", "9999", "high"] {
            assert_eq!(height(nonsense), None, "{nonsense}");
        }
        assert_eq!(height("828"), Some(RoofSpec::HeightAboveBase(828.0)));
        let elevation = HeightRule::RoofElevation {
            field: "z".to_owned(),
        };
        assert_eq!(roof(elevation, "-2"), Some(RoofSpec::Elevation(-2.0)));
    }

    #[test]
    fn storeys_under_the_roof_are_added_and_ground_is_taken_off() {
        let levels = HeightField {
            field: "building:levels".to_owned(),
            reading: HeightReading::Storeys {
                plus: Some("roof:levels".to_owned()),
                storey_height_m: 3.0,
            },
        };
        let metres = |height| Some(RoofSpec::HeightAboveBase(height));
        assert_eq!(levels.roof_from_text("4", Some("1")), metres(15.0));
        assert_eq!(levels.roof_from_text("4", None), metres(12.0));
        assert_eq!(levels.roof_from_text("4", Some("-2")), metres(12.0));
        assert_eq!(levels.roof_from_text("9999", None), None, "PLATEAU's unknown");
        let pair = HeightField {
            field: "b3_h_dak_70p".to_owned(),
            reading: HeightReading::RoofLessGround {
                ground: "b3_h_maaiveld".to_owned(),
            },
        };
        assert_eq!(pair.roof_from_text("9.25", Some("-0.75")), metres(10.0));
        assert_eq!(pair.roof_from_text("9.25", None), None);
    }

    #[test]
    fn a_rule_survives_the_manifest() {
        let rule = HeightRule::KnownFields {
            fields: vec![HeightField {
                field: "height".to_owned(),
                reading: HeightReading::Height { unit_m: 1.0 },
            }],
        };
        let text = toml::to_string(&rule).unwrap();
        assert_eq!(toml::from_str::<HeightRule>(&text).unwrap(), rule);
    }
}
