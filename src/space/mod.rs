//! Where things are: bounds, the tile grid, coordinate reference systems and the camera pose.
//!
//! Everything here is metres and radians, f64, in the city's own projected CRS (east, north, up).

pub mod atmosphere;
mod bounds;
mod crs;
mod flight_curve;
mod image_window;
mod monotone_curve;
mod pose;
mod sun;
mod sun_position;
mod tile_grid;

pub use bounds::Bounds;
pub use crs::{Accuracy, Crs, CrsError, GeoArea, MissingGrids, Operation, OperationWarning, PointTransform};
pub use flight_curve::FlightCurve;
pub use image_window::ImageWindow;
pub use monotone_curve::MonotoneCurve;
pub use pose::{Pose, Projection};
pub use sun::{SOLAR_ANGULAR_RADIUS, SUN_ABOVE_AIR, Sun};
pub use sun_position::{Place, SunError, sun_direction_at, sun_direction_in_world};
pub use tile_grid::{TileGrid, TileId};
