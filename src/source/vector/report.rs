//! What became of every feature of a footprint file.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Counts of features; `read = kept + the sum of left_out`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FootprintReport {
    /// Features in the source.
    pub read: u64,
    /// Features that became buildings.
    pub kept: u64,
    /// Kept features that had to be changed, by what was done.
    pub mended: BTreeMap<String, u64>,
    /// Features that became no building, by why.
    pub left_out: BTreeMap<String, u64>,
    /// Kept features that got the default height, by why.
    pub default_heights: BTreeMap<String, u64>,
    /// Features whose outline is exactly that of an earlier one (both are kept).
    pub duplicates: u64,
}

impl FootprintReport {
    /// Counts a feature that becomes no building.
    pub fn leave_out(&mut self, why: &str) {
        *self.left_out.entry(why.to_owned()).or_default() += 1;
    }

    /// Takes back a kept feature.
    pub fn leave_out_kept(&mut self, why: &str) {
        self.kept -= 1;
        self.leave_out(why);
    }

    /// Counts a change to a kept feature.
    pub fn mend(&mut self, what: &str) {
        *self.mended.entry(what.to_owned()).or_default() += 1;
    }

    /// Counts a default height.
    pub fn default_height(&mut self, why: &str) {
        *self.default_heights.entry(why.to_owned()).or_default() += 1;
    }
}
