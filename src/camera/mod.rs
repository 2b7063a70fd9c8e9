//! The optics between radiance and the picture. Now: the sum of samples, exposure and tone mapping. The lens, its depth
//! of field and its flare go between the sum and the exposure.

mod develop;
mod shaders;

pub use develop::Develop;
pub use shaders::ALL as SHADERS;
