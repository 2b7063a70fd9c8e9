//! What the camera's lens adds to an image: a target of its own, drawn anew only when something of the flare changed.

use std::sync::Arc;

use super::{FrameRequest, RenderError, Renderer};
use crate::camera::flare::{
    Aperture, FlareEffect, FlareRequest, GhostParameters, GhostTable, Preset, StarburstParameters,
};
use crate::gpu::{BySize, Gpu, PassTimer, Target};

/// How the flare of a lens is made.
#[derive(Clone, Debug)]
pub struct FlareSettings {
    /// The iris.
    pub aperture: Aperture,
    /// How ghosts are made; none are drawn without.
    pub ghosts: Option<GhostParameters>,
    /// How the starburst is made.
    pub starburst: StarburstParameters,
    /// Ghosts made beforehand for the same lens and f-number.
    pub table: Option<Arc<GhostTable>>,
}

impl FlareSettings {
    /// All ghosts and the starburst, as a preset makes them.
    pub fn from_preset(preset: Preset, aperture: Aperture) -> Self {
        Self {
            aperture,
            ghosts: Some(preset.ghosts()),
            starburst: preset.starburst(),
            table: None,
        }
    }
}

/// The flare of the camera's lens.
pub(super) struct FlarePass {
    effect: FlareEffect,
    target: BySize<Target>,
    /// Whether the target shows something else than the effect.
    is_stale: bool,
    /// Whether the effect shows a flare.
    is_lit: bool,
}

/// Format of the flare's radiance.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

impl FlarePass {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            effect: FlareEffect::new(gpu, FORMAT),
            target: BySize::default(),
            is_stale: true,
            is_lit: false,
        }
    }

    pub(super) fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) {
        self.target
            .select(size, || Target::new(gpu, "flare", size, FORMAT));
        self.is_stale = true;
    }

    /// Part of the sun's light that its sharp image keeps, mean of the channels.
    pub(super) fn disc_fraction(&self) -> f64 {
        if self.is_lit {
            self.effect.disc_fraction().iter().sum::<f64>() / 3.0
        } else {
            1.0
        }
    }

    /// Radiance that the lens adds.
    pub(super) fn target(&self) -> Option<&Target> {
        self.target.current()
    }

    /// Draws the flare where it changed; else a pass that draws nothing, so that it has its times.
    pub(super) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, timed: (&PassTimer, u32)) {
        let Some(target) = self.target.current() else {
            return;
        };
        let is_drawn = self.is_stale && self.is_lit;
        let attachment = if self.is_stale {
            target.cleared(wgpu::Color::TRANSPARENT)
        } else {
            target.loaded()
        };
        let (timer, number) = timed;
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("no flare"),
            color_attachments: &[attachment],
            timestamp_writes: if is_drawn { None } else { timer.pass(number) },
            ..Default::default()
        }));
        if is_drawn {
            self.effect.encode(encoder, target, Some(timed));
        }
        self.is_stale = false;
    }
}

impl Renderer {
    /// Brings the flare up to date with the camera and the sun.
    pub(super) fn prepare_flare(&mut self, request: &FrameRequest<'_>) -> Result<(), RenderError> {
        let (Some(optics), Some(settings)) = (request.camera.lens(), request.flare) else {
            self.flare.is_stale |= self.flare.is_lit;
            self.flare.is_lit = false;
            return Ok(());
        };
        let light = request.camera.light_from(&self.sun_seen(request));
        let flare = FlareRequest {
            lens: Arc::clone(&optics.lens),
            f_number: optics.f_number,
            aperture: settings.aperture,
            ghosts: settings.ghosts,
            starburst: Some(settings.starburst),
            table: settings.table.clone(),
            light,
            image_half_mm: optics.image_half_mm(request.size),
        };
        self.flare.is_stale |= self.flare.effect.prepare(&self.gpu, &flare, request.size)?;
        self.flare.is_lit = light.is_lit();
        Ok(())
    }
}
