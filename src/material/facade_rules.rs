//! Which facade and roof a building gets: rules in a file that the user can edit (`data/facades.toml` says how), the first that fits.

use geo::{Area, LineString, MultiPolygon};
use serde::Deserialize;
use thiserror::Error;

use super::noise::hash;
use super::own_facade::{MAX_OWN_FACADES, OwnFacade};
use super::{BuildingMaterial, Facade, FacadeStyle, RoofStyle};
use crate::source::BuildingTraits;

/// Rules, in order.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FacadeRules {
    /// Facades of the user's own.
    #[serde(default, rename = "facade")]
    own: Vec<OwnFacade>,
    rule: Vec<Rule>,
}

/// One rule.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rule {
    uses: Option<Vec<String>>,
    min_height_m: Option<f64>,
    max_height_m: Option<f64>,
    min_area_m2: Option<f64>,
    max_area_m2: Option<f64>,
    min_storeys: Option<u32>,
    max_storeys: Option<u32>,
    min_year: Option<i32>,
    max_year: Option<i32>,
    facades: Vec<String>,
    roofs: Vec<RoofStyle>,
    #[serde(default)]
    shops: f32,
}

/// A file of rules cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RulesError {
    /// It is no such file.
    #[error("{0}")]
    Syntax(String),
    /// A rule names nothing to choose from.
    #[error("rule {0} names no facade or no roof")]
    Empty(usize),
    /// A word is empty, or a part is no part.
    #[error("rule {0} has an empty word among its uses, or shops that are not between 0 and 1")]
    Value(usize),
    /// A facade of the user's own cannot be used.
    #[error("facade '{0}': {1}")]
    Facade(String, &'static str),
    /// A rule names a facade that there is not.
    #[error("rule {0} names a facade '{1}', which is neither one of the program's nor described in the file")]
    Unknown(usize, String),
    /// Some building fits no rule.
    #[error("the last rule has conditions: end with one without, for all other buildings")]
    Open,
}

/// A building as rules see it.
struct Seen<'a> {
    height_m: f64,
    area_m2: f64,
    storeys: u32,
    traits: &'a BuildingTraits,
}

/// Storeys of a building whose dataset tells none: of this height, metres.
const USUAL_STOREY_M: f64 = 3.1;
/// Plausible heights of a storey, metres: a number of storeys that gives others is not believed.
const STOREY_M: std::ops::RangeInclusive<f64> = 2.2..=6.5;

impl FacadeRules {
    /// The project's own rules.
    pub const BUILT_IN: &str = include_str!("../../data/facades.toml");

    /// Reads a file's text.
    ///
    /// # Errors
    /// When it is no file of rules, or some building would fit none.
    pub fn from_text(text: &str) -> Result<Self, RulesError> {
        let mut rules: Self = toml::from_str(text).map_err(|error| RulesError::Syntax(error.to_string()))?;
        for (index, rule) in rules.rule.iter_mut().enumerate() {
            for word in rule.uses.iter_mut().flatten() {
                *word = word.trim().to_lowercase();
            }
            let is_blank = rule.uses.iter().flatten().any(String::is_empty);
            if is_blank || !(0.0..=1.0).contains(&rule.shops) {
                return Err(RulesError::Value(index + 1));
            }
        }
        rules.check_facades()?;
        let is_empty = |rule: &Rule| rule.facades.is_empty() || rule.roofs.is_empty();
        if let Some(index) = rules.rule.iter().position(is_empty) {
            return Err(RulesError::Empty(index + 1));
        }
        match rules.rule.last().is_some_and(Rule::is_open) {
            true => Ok(rules),
            false => Err(RulesError::Open),
        }
    }

    /// Facades of the user's own.
    pub fn own_facades(&self) -> &[OwnFacade] {
        &self.own
    }

    fn check_facades(&self) -> Result<(), RulesError> {
        let refused = |own: &OwnFacade, why| Err(RulesError::Facade(own.name.clone(), why));
        for (index, own) in self.own.iter().enumerate() {
            let is_taken =
                style_of(&own.name).is_some() || self.own[..index].iter().any(|other| other.name == own.name);
            match own.fault() {
                Some(why) => return refused(own, why),
                None if is_taken => return refused(own, "there is another one of that name"),
                None if index >= MAX_OWN_FACADES => {
                    return refused(own, "is one more than the 16 that there can be");
                }
                None => {}
            }
        }
        let rules = self.rule.iter().enumerate();
        let mut names = rules.flat_map(|(index, rule)| rule.facades.iter().map(move |name| (index, name)));
        match names.find(|(_, name)| self.facade(name).is_none()) {
            Some((index, name)) => Err(RulesError::Unknown(index + 1, name.clone())),
            None => Ok(()),
        }
    }

    fn facade(&self, name: &str) -> Option<Facade> {
        let own = || {
            let index = self.own.iter().position(|own| own.name == name)?;
            Some(Facade {
                number: (FacadeStyle::ALL.len() + index) as u32,
                bay_m: self.own[index].bay_m,
                storey_m: self.own[index].storey_m,
            })
        };
        style_of(name).map(Facade::from).or_else(own)
    }

    /// What a building is made of; `height_m`: of its roof above its base.
    pub fn material(
        &self,
        fid: u32,
        outline: &MultiPolygon<f64>,
        height_m: f64,
        traits: &BuildingTraits,
    ) -> BuildingMaterial {
        let told = |storeys: &u32| STOREY_M.contains(&(height_m / f64::from(*storeys)));
        let storeys = traits.storeys.filter(told);
        let seen = Seen {
            height_m,
            area_m2: outline.unsigned_area(),
            storeys: storeys
                .unwrap_or((height_m / USUAL_STOREY_M).round() as u32)
                .max(1),
            traits,
        };
        let fallback = Rule::ANY;
        let rule = self
            .rule
            .iter()
            .find(|rule| rule.fits(&seen))
            .unwrap_or(&fallback);
        let pick = |count: usize, salt: u32| (hash(fid, salt, 17) * count as f32) as usize;
        let facade = rule.facades.get(pick(rule.facades.len(), 1));
        let facade = facade.and_then(|name| self.facade(name));
        let roof = rule.roofs.get(pick(rule.roofs.len(), 2)).copied();
        let facade = facade.unwrap_or(FacadeStyle::Render.into());
        let fitted = storeys.map_or(height_m / facade.storey_m, f64::from);
        BuildingMaterial {
            facade,
            has_shops: hash(fid, 3, 17) < rule.shops,
            roof: roof.unwrap_or(RoofStyle::Gravel),
            storeys: fitted.round().clamp(1.0, 255.0) as u8,
            direction: direction(outline),
        }
    }
}

impl Default for FacadeRules {
    fn default() -> Self {
        Self::from_text(Self::BUILT_IN).unwrap_or(Self {
            own: Vec::new(),
            rule: Vec::new(),
        })
    }
}

/// The project's facade of a name.
fn style_of(name: &str) -> Option<FacadeStyle> {
    let named = serde::de::value::StrDeserializer::<serde::de::value::Error>::new(name);
    FacadeStyle::deserialize(named).ok()
}

impl Rule {
    /// Fits every building.
    const ANY: Self = Self {
        uses: None,
        min_height_m: None,
        max_height_m: None,
        min_area_m2: None,
        max_area_m2: None,
        min_storeys: None,
        max_storeys: None,
        min_year: None,
        max_year: None,
        facades: Vec::new(),
        roofs: Vec::new(),
        shops: 0.0,
    };

    fn fits(&self, seen: &Seen<'_>) -> bool {
        let uses = &seen.traits.uses;
        // Whole words: a town hall is no hall.
        let words = |text: &str| -> Vec<String> {
            text.split(|c: char| !c.is_alphanumeric() && c != '_')
                .map(str::to_owned)
                .collect()
        };
        let is_named = |own: &String, word: &String| own == word || words(own).contains(word);
        let is_used = |words: &Vec<String>| {
            words
                .iter()
                .any(|word| uses.iter().any(|own| is_named(own, word)))
        };
        let year = seen.traits.year;
        self.uses.as_ref().is_none_or(is_used)
            && self.min_height_m.is_none_or(|min| seen.height_m >= min)
            && self.max_height_m.is_none_or(|max| seen.height_m <= max)
            && self.min_area_m2.is_none_or(|min| seen.area_m2 >= min)
            && self.max_area_m2.is_none_or(|max| seen.area_m2 <= max)
            && self.min_storeys.is_none_or(|min| seen.storeys >= min)
            && self.max_storeys.is_none_or(|max| seen.storeys <= max)
            && self
                .min_year
                .is_none_or(|min| year.is_some_and(|year| year >= min))
            && self
                .max_year
                .is_none_or(|max| year.is_some_and(|year| year <= max))
    }

    fn is_open(&self) -> bool {
        let facades = self.facades.clone();
        let roofs = self.roofs.clone();
        *self
            == Self {
                facades,
                roofs,
                shops: self.shops,
                ..Self::ANY
            }
    }
}

/// Direction of the longest edge, in 256ths of half a circle from east towards north.
fn direction(outline: &MultiPolygon<f64>) -> u8 {
    let rings = outline.iter().map(geo::Polygon::exterior);
    let edges = rings.flat_map(LineString::lines);
    let longest = edges.max_by(|a, b| {
        let length = |edge: &geo::Line<f64>| edge.dx().hypot(edge.dy());
        length(a).total_cmp(&length(b))
    });
    let angle = longest.map_or(0.0, |edge| edge.dy().atan2(edge.dx()));
    (angle.rem_euclid(std::f64::consts::PI) / std::f64::consts::PI * 256.0) as u32 as u8
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use geo::polygon;

    fn made(uses: &[&str], storeys: Option<u32>, height_m: f64) -> BuildingMaterial {
        let outline = MultiPolygon::new(vec![polygon![
            (x: 0.0, y: 0.0), (x: 20.0, y: 0.0), (x: 20.0, y: 10.0), (x: 0.0, y: 10.0)
        ]]);
        let traits = BuildingTraits {
            uses: uses.iter().map(|word| (*word).to_owned()).collect(),
            storeys,
            year: None,
        };
        FacadeRules::default().material(7, &outline, height_m, &traits)
    }

    #[test]
    fn the_first_rule_that_fits_counts() {
        assert_eq!(made(&["warehouse"], None, 9.0).facade, FacadeStyle::Shed.into());
        assert_eq!(made(&["church"], None, 20.0).facade, FacadeStyle::Stone.into());
        assert_eq!(made(&["townhall"], None, 20.0).facade, FacadeStyle::Stone.into());
        assert_ne!(
            made(&["commercial et services"], None, 9.0).facade,
            FacadeStyle::Shed.into()
        );
        assert!(made(&["bakery", "shop"], None, 9.0).has_shops);
        assert_eq!(
            made(&["slab"], Some(5), 15.0).facade,
            FacadeStyle::Concrete.into()
        );
        let rules = "[[rule]]\nmin_height_m = 5\nfacades = ['brick']\nroofs = ['metal']\n[[rule]]\nfacades = ['house']\nroofs = ['slate']\n";
        let rules = FacadeRules::from_text(rules).unwrap();
        let outline = MultiPolygon::new(Vec::new());
        let of = |height| rules.material(1, &outline, height, &BuildingTraits::default());
        assert_eq!(
            (of(6.0).facade, of(6.0).roof),
            (FacadeStyle::Brick.into(), RoofStyle::Metal)
        );
        assert_eq!(
            (of(4.0).facade, of(4.0).roof),
            (FacadeStyle::House.into(), RoofStyle::Slate)
        );
    }

    /// The dataset's storeys where they are plausible, whole ones of the facade's height otherwise.
    #[test]
    fn storeys_are_whole() {
        assert_eq!(made(&["slab"], Some(5), 15.0).storeys, 5);
        assert_eq!(made(&["slab"], Some(1), 15.0).storeys, 5);
        assert_eq!(made(&["slab"], None, 0.4).storeys, 1);
        assert_eq!(made(&["slab"], None, 10_000.0).storeys, 255);
    }

    #[test]
    fn files_that_cannot_be_used_are_refused() {
        let open = "[[rule]]\nmin_height_m = 5\nfacades = ['brick']\nroofs = ['metal']\n";
        assert_eq!(FacadeRules::from_text(open), Err(RulesError::Open));
        let unknown = "[[rule]]\nfacades = ['marble']\nroofs = ['metal']";
        assert_eq!(
            FacadeRules::from_text(unknown),
            Err(RulesError::Unknown(1, "marble".to_owned()))
        );
        let own = |name: &str, middle: &str| {
            format!(
                "[[facade]]\nname = '{name}'\nbay_m = 3\nstorey_m = 3\nmiddle = '{middle}'\n{}",
                unknown.replace("marble", name)
            )
        };
        assert!(FacadeRules::from_text(&own("marble", "m.png")).is_ok());
        for (name, middle) in [
            ("brick", "m.png"),
            ("a", "/m.png"),
            ("a", "../m.png"),
            ("a", "m.jpg"),
        ] {
            let refused = FacadeRules::from_text(&own(name, middle));
            assert!(matches!(refused, Err(RulesError::Facade(..))), "{name} {middle}");
        }
        let empty = "[[rule]]\nfacades = []\nroofs = ['metal']\n";
        assert_eq!(FacadeRules::from_text(empty), Err(RulesError::Empty(1)));
        for text in ["rule = 1", "[[rule]]\nfacade = 'brick'"] {
            assert!(
                matches!(FacadeRules::from_text(text), Err(RulesError::Syntax(_))),
                "{text}"
            );
        }
    }
}
