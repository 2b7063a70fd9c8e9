//! A photographic lens as its prescription: a table of surfaces in millimetres, read from a data file.
//!
//! ```text
//! .toml .csv .zmx .seq .dat ─▶ prescription (radius, thickness, glass, semi-diameter, conic, asphere, coating)
//! ```

mod built_in;
mod catalogue;
mod coating;
mod codev;
mod csv;
mod error;
mod glass;
mod open;
mod pbrt;
mod prescription;
mod table;
mod zemax;

pub use built_in::{BUILT_IN, built_in};
pub use coating::{Coating, Layer, reflectance};
pub use error::LensError;
pub use glass::{D_LINE_UM, Glass};
pub use open::open;
pub use prescription::{Lens, Surface};
pub use table::to_toml;
