//! Rasters: the bare-earth terrain (`dtm`) and aerial photos (`photo`).

mod dtm;
mod photo;
mod sampler;
mod sheet;
mod window;

pub use dtm::{Dtm, DtmSampler};
pub use photo::Photos;
