//! The parameters of the search of KR 10-0738500.

use bytemuck::{Pod, Zeroable};

/// How the search goes; layout of `SearchParameters` in `shaders/lib/search_parameters.wgsl`, where each is explained.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SearchParameters {
    /// Slices of the volume.
    pub slices: u32,
    /// Halvings between the last two.
    pub refinements: u32,
    /// A surface that rises by more than this over the slice above it is steep, metres.
    pub delta: f32,
    /// Nothing.
    pub padding: u32,
}

impl Default for SearchParameters {
    fn default() -> Self {
        Self {
            slices: 64,
            refinements: 8,
            delta: 1.0,
            padding: 0,
        }
    }
}

/// Width of a bay on walls that are found, metres: their outlines are not known.
pub const SEARCH_BAY_M: f32 = 3.0;
