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

    /// The counts of features that were read twice: as they came (`first`), and as they were taken over.
    pub fn after(mut self, first: Self) -> Self {
        self.read = first.read;
        for (counts, more) in [
            (&mut self.rejected, first.rejected),
            (&mut self.repaired, first.repaired),
        ] {
            for (what, number) in more {
                *counts.entry(what).or_default() += number;
            }
        }
        self
    }

    /// The counts of a dataset of which the features counted in `before` became those counted in `after`.
    pub fn replaced(&self, before: &Self, after: &Self) -> Self {
        let count = |whole: u64, before: u64, after: u64| (whole + after).saturating_sub(before);
        let counts = |pick: fn(&Self) -> &BTreeMap<String, u64>| {
            let mut counts = pick(self).clone();
            for (what, &number) in pick(after) {
                *counts.entry(what.clone()).or_default() += number;
            }
            for (what, &number) in pick(before) {
                let left = counts.entry(what.clone()).or_default();
                *left = left.saturating_sub(number);
            }
            counts.retain(|_, &mut number| number > 0);
            counts
        };
        let mut heights = self.heights.clone();
        for field in &mut heights {
            let find = |report: &Self| {
                let found = report.heights.iter().find(|other| other.field == field.field);
                found.map_or((0, 0), |found| (found.buildings, found.unusable))
            };
            let (before, after) = (find(before), find(after));
            field.buildings = count(field.buildings, before.0, after.0);
            field.unusable = count(field.unusable, before.1, after.1);
        }
        Self {
            read: count(self.read, before.read, after.read),
            kept: count(self.kept, before.kept, after.kept),
            repaired: counts(|report| &report.repaired),
            rejected: counts(|report| &report.rejected),
            heights,
            default_heights: counts(|report| &report.default_heights),
            duplicates: self.duplicates,
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
