//! Where things are: bounds, the tile grid, coordinate reference systems and the camera pose.
//!
//! Everything here is metres and radians, f64, in the city's own projected CRS (east, north, up).

mod bounds;
mod crs;
mod sun;
mod tile_grid;
mod view;

pub use bounds::Bounds;
pub use crs::{Accuracy, Crs, CrsError, GeoArea, MissingGrids, Operation, OperationWarning, PointTransform};
pub use sun::{Place, SunError, sun_direction_in_world, sun_from_azimuth_altitude};
pub use tile_grid::{TileGrid, TileId};
pub use view::{Projection, View};
