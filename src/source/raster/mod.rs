//! Rasters: the bare-earth terrain (`dtm`) and aerial orthophotos (`orthophoto`).

mod dtm;
mod height_steps;
mod imagery_mosaic;
mod mosaic_source;
mod sampler;
mod smoothing;
mod smoothing_grid;
mod whole_raster;
mod window;

pub use dtm::{Dtm, DtmSampler, SampleLattice, SteppedHeights};
pub use imagery_mosaic::ImageryMosaic;
