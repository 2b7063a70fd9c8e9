//! How roads, rails, water and green are drawn on the ground: rules in a file that the user can edit (`data/ground.toml`).

use std::path::Path;

use indexmap::IndexMap;
use serde::Deserialize;

use super::{SourceError, open_regular};

/// A colour, sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Colour(pub [u8; 3]);

impl TryFrom<String> for Colour {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
        let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let [_, r, g, b] = number
            .ok_or_else(|| format!("'{text}' is no colour such as #7f9a62"))?
            .to_be_bytes();
        Ok(Self([r, g, b]))
    }
}

/// All rules.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundRules {
    /// Streets and paths.
    pub roads: RoadRules,
    /// Railways.
    pub rail: RailRules,
    /// Rivers and lakes.
    pub water: AreaRules,
    /// Parks and woods.
    pub green: AreaRules,
}

/// Of streets and paths.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct RoadRules {
    pub usual_m: f64,
    pub pavements_from_m: f64,
    pub line_from_m: f64,
    pub pavement: Colour,
    pub carriageway: Colour,
    pub line: Colour,
    pub path: Colour,
    /// By class.
    pub widths_m: IndexMap<String, f64>,
}

/// Of railways.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct RailRules {
    pub usual_m: f64,
    pub bed: Colour,
    pub track: Colour,
    /// By class.
    pub widths_m: IndexMap<String, f64>,
}

/// Of what covers areas.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct AreaRules {
    /// Width of a line.
    pub usual_m: f64,
    /// Of what has no class.
    pub colour: Colour,
    /// Of lines, by class.
    #[serde(default)]
    pub widths_m: IndexMap<String, f64>,
    /// By class.
    pub colours: IndexMap<String, Colour>,
}

/// Most bytes of such a file.
const MAX_BYTES: u64 = 1 << 20;
/// Widest line, metres.
const MAX_WIDTH_M: f64 = 200.0;

impl GroundRules {
    /// The project's own rules.
    pub const BUILT_IN: &str = include_str!("../../data/ground.toml");

    /// Reads a file.
    ///
    /// # Errors
    /// When it cannot be read or used.
    pub fn read(path: &Path) -> Result<Self, SourceError> {
        let refused = |what: String| SourceError::Unfit {
            path: path.to_owned(),
            what: format!("is no file of ground rules ({what})"),
            advice: "mend it: data/ground.toml of this program is an example that says how".to_owned(),
        };
        let text = match std::fs::metadata(path) {
            Ok(data) if data.len() > MAX_BYTES => Err("it is larger than a megabyte".to_owned()),
            _ => open_regular(path)
                .and_then(std::io::read_to_string)
                .map_err(|error| error.to_string()),
        };
        text.and_then(|text| Self::from_text(&text)).map_err(refused)
    }

    fn from_text(text: &str) -> Result<Self, String> {
        let rules: Self = toml::from_str(text).map_err(|error| error.to_string())?;
        match rules.unfit_width() {
            Some(width) => Err(format!("a width of {width} m is not between 0 and {MAX_WIDTH_M}")),
            None => Ok(rules),
        }
    }

    fn unfit_width(&self) -> Option<f64> {
        let Self {
            roads,
            rail,
            water,
            green,
        } = self;
        let usual = [roads.usual_m, rail.usual_m, water.usual_m, green.usual_m];
        let by_class = [&roads.widths_m, &rail.widths_m, &water.widths_m, &green.widths_m];
        let widths = usual
            .into_iter()
            .chain(by_class.into_iter().flat_map(|widths| widths.values().copied()));
        widths
            .into_iter()
            .find(|width| !(0.0..=MAX_WIDTH_M).contains(width))
    }
}

impl Default for GroundRules {
    fn default() -> Self {
        let none = Colour([0; 3]);
        Self::from_text(Self::BUILT_IN).unwrap_or(Self {
            roads: RoadRules {
                usual_m: 0.0,
                pavements_from_m: 0.0,
                line_from_m: 0.0,
                pavement: none,
                carriageway: none,
                line: none,
                path: none,
                widths_m: IndexMap::new(),
            },
            rail: RailRules {
                usual_m: 0.0,
                bed: none,
                track: none,
                widths_m: IndexMap::new(),
            },
            water: AreaRules::empty(),
            green: AreaRules::empty(),
        })
    }
}

impl AreaRules {
    fn empty() -> Self {
        Self {
            usual_m: 0.0,
            colour: Colour([0; 3]),
            widths_m: IndexMap::new(),
            colours: IndexMap::new(),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_projects_own_rules_are_sound_and_others_are_refused_by_what_is_wrong() {
        let rules = GroundRules::from_text(GroundRules::BUILT_IN).unwrap();
        assert_eq!(rules.roads.widths_m["motorway"], 14.0);
        assert_eq!(rules.green.colours["forest"], Colour([0x6a, 0x7d, 0x52]));
        for (from, to, told) in [
            ("#6a7d52", "green", "no colour"),
            ("motorway = 14.0", "motorway = -1.0", "width of -1"),
            ("usual_m = 3.5", "usual = 3.5", "unknown field"),
        ] {
            let text = GroundRules::BUILT_IN.replacen(from, to, 1);
            let error = GroundRules::from_text(&text).unwrap_err();
            assert!(error.contains(told), "{error}");
        }
    }
}
