//! What the camera's lens adds to an image: a target of its own, drawn anew only when something of the flare changed.

use super::{FrameRequest, RenderError, Renderer};
use crate::gpu::{Gpu, Target};

/// How the flare of a lens is made.
#[derive(Clone, Debug)]
pub struct FlareSettings {}

/// The flare of the camera's lens.
pub struct FlarePass {
    target: Option<Target>,
}

/// Format of the flare's radiance.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

impl FlarePass {
    pub(super) fn new(_gpu: &Gpu) -> Self {
        Self { target: None }
    }

    pub(super) fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) {
        self.target = Some(Target::new(gpu, "flare", size, FORMAT));
    }

    /// Radiance that the lens adds.
    pub(super) fn target(&self) -> Option<&Target> {
        self.target.as_ref()
    }

    pub(super) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        if let Some(target) = &self.target {
            drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("flare"),
                color_attachments: &[target.loaded()],
                timestamp_writes: timestamps,
                ..Default::default()
            }));
        }
    }
}

impl Renderer {
    pub(super) fn prepare_flare(&mut self, _request: &FrameRequest<'_>) -> Result<(), RenderError> {
        Ok(())
    }
}
