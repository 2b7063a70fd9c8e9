//! The device, shader modules, render targets, read-back and timing. Knows nothing of cities.

mod band;
mod bindings;
mod by_size;
mod device;
mod pipeline;
mod readback;
mod shader;
mod target;
mod layer_pool;
mod index_pool;
mod record_pool;
mod texel_pool;
mod timing;
mod upload;

pub use band::Band;
pub use bindings::{
    FILTERED, FLOAT, OUTPUT, RECORDS, SAMPLER, UNIFORM, texture, texture_array, texture_volume,
};
pub use by_size::BySize;
pub use device::{Gpu, GpuError};
pub use index_pool::{IndexPool, IndexRun};
pub use layer_pool::LayerPool;
pub use pipeline::PipelineParameters;
pub use readback::{read_buffer, read_texture};
pub use record_pool::RecordPool;
pub(crate) use shader::shader_file;
pub use shader::{Constant, ConstantValue, ShaderFile, ShaderSource, shader_module};
pub use target::{Target, blended_target, color_target};
pub use texel_pool::{TexelPool, TexelRun};
pub use timing::{PassTimer, PassTimes};
pub use upload::{
    TableTexture, Uniform, empty_buffer, filled_texture, filled_volume, geometry_buffer, storage_buffer,
};
