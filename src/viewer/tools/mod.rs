//! What the pointer does besides moving the camera: look at buildings, measure, draw and change footprints.

mod draft;
mod grab;
mod marks;
mod measure;

pub use draft::Draft;
pub use grab::Grab;
pub use marks::{Mark, building_marks, corners, line_mark, outline_marks, paint_marks, pixel_of};
pub use measure::Measure;

use crate::city::BuildingDetails;

/// The tool in hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// A click selects a building.
    #[default]
    Look,
    /// Clicks measure.
    Measure,
    /// Clicks draw a footprint.
    Draw,
    /// A drag moves the selected building, or a vertex of it.
    Change,
}

/// The building that is selected.
#[derive(Clone, Debug)]
pub struct Selection {
    /// What the dataset says of it.
    pub details: BuildingDetails,
    /// Its height above its base as the panel shows it, metres.
    pub height_m: f64,
    /// Footprint area, square metres.
    pub area_m2: f64,
}

impl Selection {
    /// Of a building.
    pub fn new(details: BuildingDetails) -> Self {
        use geo::Area;
        Self {
            height_m: details.building.roof_m - details.building.base_m,
            area_m2: details.building.outline.unsigned_area(),
            details,
        }
    }
}
