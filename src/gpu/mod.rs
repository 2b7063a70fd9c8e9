//! The device, shader modules, render targets, read-back and timing. Knows nothing of cities.

mod device;
mod readback;
mod shader;
mod target;
mod timing;
mod upload;

pub use device::{Gpu, GpuError};
pub use readback::{read_buffer, read_texture};
pub use shader::{ShaderSource, shader_module};
pub use target::{Target, color_target, fullscreen_pipeline};
pub use timing::PassTimer;
pub use upload::{TextureArray, storage_buffer, uniform_buffer};
