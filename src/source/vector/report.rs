//! What became of every feature of a footprint file.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::source::{HeightOrigin, HeightRule};

/// Counts of features; `read = kept + the sum of rejected`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FootprintReport {
    /// Features in the source.
    pub read: u64,
    /// Features that became buildings.
    pub kept: u64,
    /// Kept features that had to be changed, by what was done.
    #[serde(rename = "mended")]
    pub repaired: BTreeMap<String, u64>,
    /// Features that became no building, by why.
    #[serde(rename = "left_out")]
    pub rejected: BTreeMap<String, u64>,
    /// Kept features by the field that gave their height, best field first.
    #[serde(default)]
    pub heights: Vec<FieldCount>,
    /// Kept features that got the default height, by why.
    pub default_heights: BTreeMap<String, u64>,
    /// Features whose outline is exactly that of an earlier one (both are kept).
    pub duplicates: u64,
}

/// How often a field gave a height.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FieldCount {
    /// The field and how it is read, like `"height" (metres)`.
    pub field: String,
    /// Buildings whose height it gave.
    pub buildings: u64,
    /// Buildings for which it held a value of no use (zero, negative, above a kilometre, text), and the next field was asked.
    pub unusable: u64,
}

impl FootprintReport {
    /// Nothing counted yet; one count for each of the rule's fields.
    pub fn new(rule: &HeightRule) -> Self {
        let heights = rule.fields().into_iter().map(|field| FieldCount {
            field: field.to_string(),
            ..FieldCount::default()
        });
        Self {
            heights: heights.collect(),
            ..Self::default()
        }
    }

    /// Counts a feature that becomes no building.
    pub fn reject(&mut self, why: &str) {
        *self.rejected.entry(why.to_owned()).or_default() += 1;
    }

    /// Takes back a kept feature.
    pub fn reject_accepted(&mut self, why: &str) {
        self.kept -= 1;
        self.reject(why);
    }

    /// Counts a change to a kept feature.
    pub fn repair(&mut self, what: &str) {
        *self.repaired.entry(what.to_owned()).or_default() += 1;
    }

    /// Counts what gave a building its height.
    pub fn height(&mut self, origin: HeightOrigin) {
        match origin {
            HeightOrigin::Default(why) => *self.default_heights.entry(why.to_owned()).or_default() += 1,
            HeightOrigin::Field(index) => {
                if let Some(count) = self.heights.get_mut(index) {
                    count.buildings += 1;
                }
            }
        }
    }

    /// Counts a value of no use in the field of that index.
    pub fn unusable_height(&mut self, field: Option<usize>) {
        if let Some(count) = field.and_then(|index| self.heights.get_mut(index)) {
            count.unusable += 1;
        }
    }
}
