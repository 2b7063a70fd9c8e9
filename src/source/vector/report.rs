//! What became of every feature of a footprint file.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

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
    /// Kept features that got the default height, by why.
    pub default_heights: BTreeMap<String, u64>,
    /// Features whose outline is exactly that of an earlier one (both are kept).
    pub duplicates: u64,
}

impl FootprintReport {
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

    /// Counts a default height.
    pub fn default_height(&mut self, why: &str) {
        *self.default_heights.entry(why.to_owned()).or_default() += 1;
    }
}
