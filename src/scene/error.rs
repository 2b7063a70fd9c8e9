//! Why a city could not be made resident.

use thiserror::Error;

use crate::city::CityError;
use crate::gpu::GpuError;

/// A city could not be made resident.
#[derive(Debug, Error)]
pub enum SceneError {
    /// A tile could not be read.
    #[error(transparent)]
    City(#[from] CityError),
    /// The device refused it.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}
