//! A building as the footprint dataset knows it: an outline and one number for its roof.

use geo::MultiPolygon;

/// One footprint in the city's CRS. Outer rings run counter-clockwise, holes clockwise, so the
/// building is always to the left of its outline.
#[derive(Clone, Debug)]
pub struct Footprint {
    /// The source's own id, where its format has stable ones, else the feature's index in the source, from 1.
    pub fid: u32,
    /// Outer rings and holes, metres.
    pub outline: MultiPolygon<f64>,
    /// How high it is.
    pub roof: RoofSpec,
    /// What says so.
    pub height_origin: HeightOrigin,
    /// What it is.
    pub traits: BuildingTraits,
    /// Whether the outline is, coordinate by coordinate, what the source holds.
    pub is_as_stored: bool,
}

/// What the dataset says of a building that its facade can go by.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BuildingTraits {
    /// Words for its use, in lower case.
    pub uses: Vec<String>,
    /// Storeys above ground.
    pub storeys: Option<u32>,
    /// Year of construction.
    pub year: Option<i32>,
}

/// What the map says of the roof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RoofSpec {
    /// Metres above the lowest ground at the outline's vertices.
    HeightAboveBase(f64),
    /// Metres above the vertical datum.
    Elevation(f64),
}

/// Where a footprint's height comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeightOrigin {
    /// The field of that index in the height rule's list.
    Field(usize),
    /// The default height, and why.
    Default(&'static str),
}
