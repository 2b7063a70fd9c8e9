//! Why there is no image.

use thiserror::Error;

/// An image could not be made.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The city could not be loaded.
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneError),
    /// A tile or the footprint dataset could not be read.
    #[error(transparent)]
    City(#[from] crate::city::CityError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] crate::gpu::GpuError),
}
