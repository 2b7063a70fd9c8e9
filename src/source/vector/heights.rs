//! A feature's roof from its attributes, by a height rule.

use gdal::vector::{Defn, Feature};

use super::FootprintSource;
use super::feature::FieldPlace;
use crate::source::{HeightField, HeightOrigin, HeightRule, RoofSpec, SourceError};

/// The column of the OSM driver that holds what has no column of its own.
pub const OTHER_TAGS: &str = "other_tags";

/// A rule's fields found in a layer.
pub struct HeightReader {
    fields: Vec<Found>,
    default: RoofSpec,
}

struct Found {
    field: HeightField,
    column: Option<FieldPlace>,
    companion: Option<FieldPlace>,
}

/// What a feature's attributes say.
pub struct ReadHeight {
    /// The roof.
    pub roof: RoofSpec,
    /// What said so.
    pub origin: HeightOrigin,
    /// Index of the first field that held a value of no use, if there was one.
    pub unusable: Option<usize>,
}

impl HeightReader {
    /// Finds the fields. Those that the user named must exist; known ones may have been taken out since.
    ///
    /// # Errors
    /// `SourceError::NoField` for a named field that does not exist.
    pub fn new(
        source: &FootprintSource,
        defn: &Defn,
        rule: &HeightRule,
        default_height_m: f64,
    ) -> Result<Self, SourceError> {
        let tags = defn.field_index(OTHER_TAGS).ok().map(FieldPlace::OtherTags);
        let find = |name: &str| defn.field_index(name).ok().map(FieldPlace::Column).or(tags);
        let mut fields = Vec::new();
        for field in rule.fields() {
            let column = find(&field.field);
            if column.is_none() && rule.is_given() {
                return Err(SourceError::NoField {
                    path: source.path.clone(),
                    field: field.field,
                    fields: defn.fields().map(|field| field.name()).collect(),
                });
            }
            let companion = field.companion().and_then(find);
            fields.push(Found {
                field,
                column,
                companion,
            });
        }
        Ok(Self {
            fields,
            default: RoofSpec::HeightAboveBase(default_height_m),
        })
    }

    /// The first field with a usable value, else the default height.
    pub fn read(&self, feature: &Feature<'_>) -> ReadHeight {
        let mut unusable = None;
        for (index, found) in self.fields.iter().enumerate() {
            let Some(text) = found
                .column
                .and_then(|column| column.text(feature, &found.field.field))
            else {
                continue;
            };
            let companion = found
                .companion
                .zip(found.field.companion())
                .and_then(|(column, key)| column.text(feature, key));
            if let Some(roof) = found.field.roof_from_text(&text, companion.as_deref()) {
                return ReadHeight {
                    roof,
                    origin: HeightOrigin::Field(index),
                    unusable,
                };
            }
            unusable = unusable.or(Some(index));
        }
        let why = match (self.fields.is_empty(), unusable) {
            (true, _) => "no field gives heights",
            (false, None) => "the height is missing",
            (false, Some(_)) => "the height is zero, negative or not a number",
        };
        ReadHeight {
            roof: self.default,
            origin: HeightOrigin::Default(why),
            unusable,
        }
    }
}
