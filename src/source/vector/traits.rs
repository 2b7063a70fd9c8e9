//! What a building is, from attributes of known names: its use, its storeys, the year it was built.

use gdal::vector::{Defn, Feature};

use super::feature::FieldPlace;
use super::heights::OTHER_TAGS;
use super::known_fields::plain;
use crate::source::BuildingTraits;

/// Names of a use: OpenStreetMap's `building:use`, `shop`, `amenity` and `building`; CityGML 2.0's `function`,
/// `usage` and `class` (12-019, 10.3.3); BD TOPO's `USAGE1` and `NATURE`; the plain words of exports.
const USES: &[&str] = &[
    "building:use",
    "shop",
    "amenity",
    "building",
    "bldg_function",
    "function",
    "usage1",
    "usage_1",
    "usage",
    "use",
    "building_use",
    "nature",
    "bldg_class",
    "class",
    "category",
    "kind",
    "type",
];

/// Names of storeys above ground (`known_fields` tells whose).
const STOREYS: &[&str] = &[
    "building:levels",
    "storeysAboveGround",
    "numberOfFloorsAboveGround",
    "NB_ETAGES",
    "nombre_d_etages",
    "num_floors",
    "numfloors",
    "storeys",
    "levels",
    "floors",
];

/// Names of the year of construction: OpenStreetMap, CityGML, BD TOPO, BAG and plain words.
const YEARS: &[&str] = &[
    "start_date",
    "yearOfConstruction",
    "year_of_construction",
    "year_built",
    "yearbuilt",
    "construction_year",
    "oorspronkelijkbouwjaar",
    "bouwjaar",
    "baujahr",
    "DATE_APP",
];

/// The fields of a layer that have them.
pub struct TraitReader {
    uses: Vec<(FieldPlace, &'static str)>,
    storeys: Vec<(FieldPlace, &'static str)>,
    years: Vec<(FieldPlace, &'static str)>,
}

impl TraitReader {
    /// Finds the fields.
    pub fn new(defn: &Defn) -> Self {
        let names: Vec<String> = defn.fields().map(|field| plain(&field.name())).collect();
        let tags = defn.field_index(OTHER_TAGS).ok().map(FieldPlace::OtherTags);
        let find = |wanted: &[&'static str]| {
            let place = |name: &&'static str| {
                let column = names.iter().position(|own| *own == plain(name));
                Some((column.map(FieldPlace::Column).or(tags)?, *name))
            };
            wanted.iter().filter_map(place).collect()
        };
        Self {
            uses: find(USES),
            storeys: find(STOREYS),
            years: find(YEARS),
        }
    }

    /// What a feature says.
    pub fn read(&self, feature: &Feature<'_>) -> BuildingTraits {
        let texts = |places: &[(FieldPlace, &'static str)]| -> Vec<String> {
            let text = |(place, name): &(FieldPlace, &str)| place.text(feature, name);
            places.iter().filter_map(text).collect()
        };
        // A shop is one, whatever it sells.
        let is_shop =
            |(place, name): &(FieldPlace, &str)| *name == "shop" && place.text(feature, name).is_some();
        let shop = self.uses.iter().any(is_shop).then(|| "shop".to_owned());
        let uses = texts(&self.uses).into_iter().chain(shop);
        let uses = uses.map(|text| text.trim().to_lowercase());
        let number = |text: &String| text.trim().parse::<f64>().ok().filter(|count| *count >= 1.0);
        // The first four digits: 1897, 1897-05-01, C1897.
        let year = |text: &String| {
            let digits = text.split(|c: char| !c.is_ascii_digit());
            digits
                .filter(|part| part.len() == 4)
                .find_map(|part| part.parse().ok())
        };
        BuildingTraits {
            uses: uses
                .filter(|text| !["yes", "no", "true", "1"].contains(&text.as_str()))
                .collect(),
            storeys: texts(&self.storeys)
                .iter()
                .find_map(number)
                .map(|count| count.min(255.0) as u32),
            year: texts(&self.years).iter().find_map(year),
        }
    }
}
