//! Rasters: the bare-earth terrain (`dtm`) and aerial orthophotos (`orthophoto`).

mod dtm;
mod imagery;
mod sampler;
mod mosaic_source;
mod window;

pub use dtm::{Dtm, DtmSampler};
pub use imagery::Imagery;
